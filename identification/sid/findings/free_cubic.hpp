// Computes the residual of a chain of masses with free cubic springs, for comparison with the
// residuals of other models.
#pragma once

#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Returns ‖y - ŷ‖ / ‖y - ȳ‖ of each response for the model at `theta` (parameters of the case)
/// with a free cubic spring parallel to each link, that is with the additional force law
///
///   T = k e + c ė + k₂ e² + k₃ e³.
///
/// The four coefficients per link minimise the sum of these squared ratios over the responses, by
/// Levenberg & Marquardt's method (Moré 1978), which starts from zero. If the optimisation ends in
/// a local minimum, the result is an upper bound of the smallest residual. The result is empty if
/// the simulation of the model fails, a response is constant, or the chain of masses has too many
/// force laws for the integrator.
[[nodiscard]] std::vector<double> free_cubic_residual(const SidProblem& problem, int model,
                                                      std::span<const double> theta);

}  // namespace wheeltap::identification
