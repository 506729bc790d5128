// A number that was computed from draws, and how well it is known.
#pragma once

#include <limits>

namespace wheeltap::inference {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double mcse = std::numeric_limits<double>::quiet_NaN();  ///< Monte Carlo standard error
};

}  // namespace wheeltap::inference
