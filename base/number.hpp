// Conversion of numbers to text.
#pragma once

#include <charconv>
#include <cstdio>
#include <string>

namespace wheeltap::base {

/// Converts x to the shortest string that converts back to x: "1e-70", "0.1", "nan".
[[nodiscard]] inline std::string number(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general).ptr;
  return {text, end};
}

/// Converts x to text with `digits` significant digits and without trailing zeros.
[[nodiscard]] inline std::string significant(double x, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

/// Converts x to text with `decimals` digits after the decimal point.
[[nodiscard]] inline std::string fixed(double x, int decimals) {
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  return text;
}

/// Converts a count to text, with digits in groups of three: "123 456".
[[nodiscard]] inline std::string grouped(long n) {
  std::string text = std::to_string(n);
  for (auto at = static_cast<long>(text.size()) - 3; at > (n < 0 ? 1 : 0); at -= 3) {
    text.insert(static_cast<std::size_t>(at), " ");
  }
  return text;
}

}  // namespace wheeltap::base
