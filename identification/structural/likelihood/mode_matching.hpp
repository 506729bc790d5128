// Matching of measured modes to computed modes.
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// Assigns each row a different column so that the sum of costs is smallest, by shortest augmenting
/// paths with potentials (Jonker & Volgenant 1987), O(rows² columns). `costs` is rows × columns,
/// rows <= columns; +∞ forbids a pair. Returns one column per row. Throws std::invalid_argument for
/// more rows than columns, or NaN.
[[nodiscard]] std::vector<int> least_cost_assignment(const Eigen::MatrixXd& costs);

}  // namespace wheeltap::identification
