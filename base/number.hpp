// Numbers in messages.
#pragma once

#include <charconv>
#include <string>

namespace wheeltap::base {

/// The shortest text that reads back as x: "1e-70", "0.1", "nan".
[[nodiscard]] inline std::string number(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general).ptr;
  return {text, end};
}

}  // namespace wheeltap::base
