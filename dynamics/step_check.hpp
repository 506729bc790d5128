// Simulation with a step length verified by step halving.
#pragma once

#include <span>

#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

/// The change is the largest over the sensors of
///
///   ‖r - r'‖ / ‖r'‖,   r' the response with steps half as long.
struct StepCheck {
  double wanted = 1e-6;     ///< steps are halved until the change is at most this,
  int most_halvings = 8;    ///< or this number of times;
  double tolerated = 1e-3;  ///< a larger change gives Outcome::steps_too_long
};

struct CheckedResponse {
  /// Unlike for a single integration, the outcome is `diverged` only if the response also diverges
  /// with steps a quarter as long; else it is `steps_too_long`.
  Response response;
  double change = 0.0;  ///< 0 for the exact solution, which has no truncation error
  /// Options of this response: extensions of its links, and the step limit that sufficed.
  SimulatorOptions options;
};

/// The response of the simulator's chain with steps chosen for this motion. A first pass gives the
/// extensions for its nonlinear laws; then steps are halved (or series used, if the laws allow) as
/// StepCheck specifies. If the simulator's options fix the number of substeps, it is kept, and the
/// result gives the change only.
[[nodiscard]] CheckedResponse checked_response(const Simulator& simulator,
                                               std::span<const double> theta,
                                               const StepCheck& check = {});

}  // namespace wheeltap::dynamics
