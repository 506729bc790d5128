// Numbers as text for readers.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

#include "base/number.hpp"

namespace wheeltap::base {

/// Converts x to text with `digits` significant digits and without trailing zeros: in decimal
/// notation from 1e-4 to a million ("350", not "3.5e+02"), otherwise with an exponent ("5.4e-6").
[[nodiscard]] inline std::string readable(double x, int digits) {
  std::string text = significant(x, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos || !std::isfinite(x)) return text;
  const int power = std::atoi(text.c_str() + e + 1);
  if (power > 0 && power < 6) return fixed(std::strtod(text.c_str(), nullptr), 0);
  return text.substr(0, e + 1) + std::to_string(power);
}

}  // namespace wheeltap::base
