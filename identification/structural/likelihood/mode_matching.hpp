// Matching of measured to computed modes.
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// The assignment of rows to different columns with the smallest sum of costs: shortest augmenting
/// paths with potentials (Jonker & Volgenant 1987), O(rows² columns). `costs`: rows × columns, rows
/// <= columns; +∞ forbids a pair. Returns one column per row. Throws std::invalid_argument for more
/// rows than columns, or NaN.
[[nodiscard]] std::vector<int> least_cost_assignment(const Eigen::MatrixXd& costs);

}  // namespace wheeltap::identification
