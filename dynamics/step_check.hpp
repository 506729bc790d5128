// A simulated response whose steps are short enough, and known to be.
#pragma once

#include <span>

#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

/// The change is the largest over the sensors of
///
///   ‖r - r'‖ / ‖r'‖,   r' the response with steps half as long.
struct StepCheck {
  double wanted = 1e-6;     ///< steps are halved until the change is at most this …
  int most_halvings = 8;    ///< … or this often,
  double tolerated = 1e-3;  ///< and a change beyond this is Outcome::steps_too_long.
};

struct CheckedResponse {
  /// Its outcome tells apart what a single integration cannot: it has diverged only if it does so
  /// with steps a quarter as long, too; else its steps were too long.
  Response response;
  double change = 0.0;  ///< 0 for the exact solution, whose steps lose nothing
  /// What gave the response: with the extensions of its links, and the step limit that sufficed.
  SimulatorOptions options;
};

/// The response of the simulator's chain with steps chosen by this motion: the extensions that its
/// nonlinear laws see are taken from a first pass, and steps are halved (or series taken, where the
/// laws let them) as StepCheck says. A number of substeps that the simulator's options fix is kept,
/// and only its change told.
[[nodiscard]] CheckedResponse checked_response(const Simulator& simulator,
                                               std::span<const double> theta,
                                               const StepCheck& check = {});

}  // namespace wheeltap::dynamics
