// The tension of a link as a function of the extension and the rate of extension.
#pragma once

#include <span>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// Computes the tension T(e, 0) = stiffness · e + Σ laws(e, 0) [N] of a link at rest at the
/// extension e [m]. Damping and friction do not contribute. Force laws with memory do not
/// contribute, because their tension depends on the history.
[[nodiscard]] double resting_tension(const Link& link, std::span<const double> theta, double e);

/// Computes the tension T(e, ė) = stiffness · e + damping · ė + Σ laws(e, ė) [N] of a link at the
/// extension e [m] and the rate of extension ė [m/s]. Force laws with memory do not contribute.
[[nodiscard]] double tension(const Link& link, std::span<const double> theta, double e,
                             double rate);

}  // namespace wheeltap::dynamics
