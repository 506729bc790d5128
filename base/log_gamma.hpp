// Thread-safe ln Γ.
#pragma once

#include <cmath>

namespace wheeltap::base {

/// Computes ln |Γ(x)|, the value of std::lgamma. std::lgamma also writes the sign of Γ to the
/// global variable signgam (POSIX 2017, lgamma). This write is a data race between threads. This
/// function does not write a global variable and does not return the sign.
[[nodiscard]] inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace wheeltap::base
