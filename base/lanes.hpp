// Elementary functions for GCC vector types (and double). All lanes execute the same operations, so
// the value computed in a lane does not depend on the width of the vector.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace wheeltap::base::lanes {

template <class V>
[[gnu::always_inline]] inline V abs(V x) {
  if constexpr (std::is_same_v<V, double>) {
    return __builtin_fabs(x);
  } else {
    using Bits = decltype(x < x);
    return (V)((Bits)x & 0x7fffffffffffffff);
  }
}

template <class V>
[[gnu::always_inline]] inline V max(V a, V b) {
  return a > b ? a : b;
}

/// Computes exp(x) for |x| <= 700 as 2ᵏ times the Taylor polynomial of exp(r), degree 13, with |r|
/// <= ½ ln 2. The polynomial has a remainder of at most 4e-18. The error of the result is below 3
/// units in the last place.
template <class V>
[[gnu::always_inline]] inline V exp(V x) {
  // Adding 1.5·2⁵² stores the nearest integer in the low bits of the mantissa.
  constexpr double kShift = 6755399441055744.0;
  const V shifted = x * 1.4426950408889634 + kShift;
  const V k = shifted - kShift;
  const V r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  V p = r * (1.0 / 6227020800.0) + 1.0 / 479001600.0;
  constexpr double kInverseFactorials[] = {
      1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
      1.0 / 120.0,      1.0 / 24.0,      1.0 / 6.0,      0.5,           1.0,          1.0};
  for (double inverse_factorial : kInverseFactorials) p = p * r + inverse_factorial;
  if constexpr (std::is_same_v<V, double>) {
    return std::ldexp(p, static_cast<int>(k));
  } else {
    using Bits = decltype(x < x);
    return (V)((Bits)p + ((Bits)shifted << 52));
  }
}

/// Computes tanh(x) with an absolute error of a few 1e-16.
template <class V>
[[gnu::always_inline]] inline V tanh(V x) {
  const V magnitude = abs(x);
  const V t = lanes::exp<V>(-2.0 * (magnitude < 20.0 ? magnitude : V{} + 20.0));
  const V y = (1.0 - t) / (1.0 + t);
  return x < 0.0 ? -y : y;
}

/// Computes xⁿ for x >= 0, lane by lane. The computation is fast for the exponents 1 and 2.
template <class V>
[[gnu::always_inline]] inline V power(V x, V n) {
  if constexpr (std::is_same_v<V, double>) {
    return n == 1.0 ? x : n == 2.0 ? x * x : std::pow(x, n);
  } else {
    V y = x;
    for (std::size_t lane = 0; lane < sizeof(V) / sizeof(double); ++lane)
      if (n[lane] != 1.0) y[lane] = n[lane] == 2.0 ? x[lane] * x[lane] : std::pow(x[lane], n[lane]);
    return y;
  }
}

}  // namespace wheeltap::base::lanes
