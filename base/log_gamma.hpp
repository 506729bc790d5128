// ln Γ, on any thread.
#pragma once

#include <cmath>

namespace wheeltap::base {

/// ln |Γ(x)|, std::lgamma's value. That writes Γ's sign, which nothing here asks for, where all
/// threads do (signgam of POSIX 2017, lgamma): a data race.
[[nodiscard]] inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace wheeltap::base
