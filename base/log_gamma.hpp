// Thread-safe ln Γ.
#pragma once

#include <cmath>

namespace wheeltap::base {

/// ln |Γ(x)|, equal to std::lgamma. std::lgamma also writes the sign of Γ, which is not needed
/// here, to a global variable (signgam of POSIX 2017, lgamma): a data race between threads.
[[nodiscard]] inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace wheeltap::base
