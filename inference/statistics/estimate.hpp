// A value computed from draws, with its Monte Carlo error.
#pragma once

#include <limits>

namespace wheeltap::inference {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double mcse = std::numeric_limits<double>::quiet_NaN();  ///< Monte Carlo standard error
};

}  // namespace wheeltap::inference
