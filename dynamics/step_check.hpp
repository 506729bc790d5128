// Simulation with a step length verified by step halving.
#pragma once

#include <span>

#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

/// Criterion of step halving. The change of a response is the largest value over the sensors of
///
///   ‖r - r'‖ / ‖r'‖,   r' the response with steps half as long.
struct StepCheck {
  double wanted = 1e-6;     ///< steps are halved until the change is at most this,
  int most_halvings = 8;    ///< or this number of times;
  double tolerated = 1e-3;  ///< a larger change gives Outcome::steps_too_long
};

struct CheckedResponse {
  /// The outcome is `diverged` only if the response also diverges with steps a quarter as long;
  /// otherwise it is `steps_too_long`.
  Response response;
  double change = 0.0;  ///< 0 for the exact solution, which has no truncation error
  /// Options with which the response was computed: extensions of the links, and the sufficient step
  /// limit.
  SimulatorOptions options;
};

/// Computes the response of the simulator's chain with steps that suit this motion. A first
/// simulation gives the extensions of the nonlinear laws. Then the steps are halved as StepCheck
/// specifies, or series are used if the laws allow. If the options fix the number of substeps, the
/// steps remain, and only the change is computed.
[[nodiscard]] CheckedResponse checked_response(const Simulator& simulator,
                                               std::span<const double> theta,
                                               const StepCheck& check = {});

}  // namespace wheeltap::dynamics
