// Simulation with a time step that is verified by halving.
#pragma once

#include <span>

#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

/// Criterion of step halving. The change of the response due to halved time steps is the maximum
/// over all sensors of
///
///   ‖r - r'‖ / ‖r'‖,   where r' is the response with time steps half as long.
struct StepCheck {
  double wanted = 1e-6;     ///< steps are halved until the change is at most `wanted`
  int most_halvings = 8;    ///< largest number of halvings
  double tolerated = 1e-3;  ///< for a larger change, the outcome is Outcome::steps_too_long
};

struct CheckedResponse {
  /// The outcome is `diverged` only if the response also diverges with time steps a quarter as
  /// long; otherwise it is `steps_too_long`.
  Response response;
  double change = 0.0;  ///< change due to halved time steps; 0 for the exact solution
  /// Options of the simulation that computed the response. The
  /// options contain the extensions of the links and the step
  /// limit that was sufficient.
  SimulatorOptions options;
};

/// Simulates the response of the simulator's chain with sufficiently short time steps. A first
/// simulation gives the extensions of links with nonlinear force laws. Then the steps are halved as
/// StepCheck specifies, or the integrator `series` is used if the laws allow it. If the options fix
/// the number of substeps, the steps are not changed, and the function only computes the change of
/// the response with halved steps.
[[nodiscard]] CheckedResponse checked_response(const Simulator& simulator,
                                               std::span<const double> theta,
                                               const StepCheck& check = {});

}  // namespace wheeltap::dynamics
