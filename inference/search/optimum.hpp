// Types shared by the optimisers.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace wheeltap::inference {

/// A function to be maximised. The function returns -∞ for a point with zero density; NaN counts as
/// -∞.
using Objective = std::function<double(std::span<const double>)>;

struct Optimum {
  std::vector<double> z;
  double value = 0.0;
  long evaluations = 0;
  bool converged = false;  ///< true if the method met its convergence criterion within its budget
};

}  // namespace wheeltap::inference
