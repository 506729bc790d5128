// The law of a link as a curve: tension against extension, and against its rate.
#pragma once

#include <span>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// T(e, 0) = stiffness · e + Σ laws(e, 0) [N] of a link held at the extension e [m]. Damping and
/// friction need a rate and count nothing; nor does a law with memory, whose tension depends on how
/// it got there.
[[nodiscard]] double resting_tension(const Link& link, std::span<const double> theta, double e);

/// T(e, ė) = stiffness · e + damping · ė + Σ laws(e, ė) [N] of a link at the extension e [m] and
/// the rate ė [m/s]; laws with memory count nothing here, either.
[[nodiscard]] double tension(const Link& link, std::span<const double> theta, double e,
                             double rate);

}  // namespace wheeltap::dynamics
