// The law of a link as a curve: tension against extension.
#pragma once

#include <span>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// T(e, 0) = stiffness · e + Σ laws(e, 0) [N] of a link held at the extension e [m]. Damping and
/// friction need a rate and count nothing; nor does a law with memory, whose tension depends on how
/// it got there.
[[nodiscard]] double resting_tension(const Link& link, std::span<const double> theta, double e);

}  // namespace wheeltap::dynamics
