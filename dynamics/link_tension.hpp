// The tension of a link as a function of its extension and of the rate of extension.
#pragma once

#include <span>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// T(e, 0) = stiffness · e + Σ laws(e, 0) [N] of a link at rest at the extension e [m]. Damping and
/// friction do not contribute, nor do laws with memory, whose tension depends on the history.
[[nodiscard]] double resting_tension(const Link& link, std::span<const double> theta, double e);

/// T(e, ė) = stiffness · e + damping · ė + Σ laws(e, ė) [N] of a link at the extension e [m] and
/// the rate ė [m/s]; laws with memory do not contribute.
[[nodiscard]] double tension(const Link& link, std::span<const double> theta, double e,
                             double rate);

}  // namespace wheeltap::dynamics
