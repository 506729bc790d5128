// What a chain that may choose its springs leaves of a record: the yardstick for models that
// leave little.
#pragma once

#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// ‖y - ŷ‖ / ‖y - ȳ‖ of each response under the free cubic chain: the model at `theta` (parameters
/// of the case) with, beside each of its links,
///
///   T = k e + c ė + k₂ e² + k₃ e³,
///
/// all four free, which minimise Σ over responses of that ratio squared by Levenberg & Marquardt's
/// method (Moré 1978) from zero. A local minimum is an upper bound of what could be left. Empty
/// where the model's response fails, a response is constant, or the chain has too many laws to be
/// integrated with these.
[[nodiscard]] std::vector<double> free_cubic_residual(const SidProblem& problem, int model,
                                                      std::span<const double> theta);

}  // namespace wheeltap::identification
