// Logarithm and minimum for GCC vector types, in addition to base/lanes.hpp.
#pragma once

#include "base/lanes.hpp"

namespace wheeltap::identification::monitoring::detail {

/// Computes ln x for normal positive x: x = 2ᵏ m with m in [√½, √2], ln m = 2 artanh((m - 1)/(m +
/// 1)) by its Taylor polynomial of degree 21. The absolute error is below 3e-16 (1 + |ln x|).
template <class V>
[[gnu::always_inline]] inline V log(V x) {
  using Bits = decltype(x < x);
  const Bits bits = (Bits)x;
  // The exponent bits e of x become the low bits of 2⁵² + e, and k = e - 1023. The sign bit is 0.
  V k = (V)((bits >> 52) | 0x4330000000000000) - (4503599627370496.0 + 1023.0);
  V m = (V)((bits & 0x000fffffffffffff) | 0x3ff0000000000000);
  const auto large = m > 1.4142135623730951;
  m = large ? 0.5 * m : m;
  k = large ? k + 1.0 : k;
  const V f = (m - 1.0) / (m + 1.0), square = f * f;
  V p = square * (2.0 / 21.0) + 2.0 / 19.0;
  constexpr double kInverse[] = {2.0 / 17.0, 2.0 / 15.0, 2.0 / 13.0, 2.0 / 11.0,
                                 2.0 / 9.0,  2.0 / 7.0,  2.0 / 5.0,  2.0 / 3.0};
  for (const double inverse : kInverse) p = p * square + inverse;
  return k * 6.93147180369123816490e-01 +
         (f * 2.0 + (f * square * p + k * 1.90821492927058770002e-10));
}

template <class V>
[[gnu::always_inline]] inline V min(V a, V b) {
  return a < b ? a : b;
}

}  // namespace wheeltap::identification::monitoring::detail
