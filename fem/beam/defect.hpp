// Beam defects: stiffness reduction in an element, or an additional support.
#pragma once

#include <limits>
#include <vector>

namespace wheeltap::fem {

/// A stiffness reduction: the element that contains `location` keeps 1 - `reduction` of its bending
/// and shear stiffness. Two reductions r1, r2 in the same element leave the fraction (1 - r1)(1 -
/// r2) of the stiffness.
struct Damage {
  double location;   ///< x [m] in [0, L]
  double reduction;  ///< r [-] in [0, 1)
};

/// A spring to ground at `location`. The shape functions of the element distribute the force of the
/// spring to its nodes. An infinite stiffness means a rigid support.
struct SpringSupport {
  double location;                                             ///< x [m] in [0, L]
  double stiffness = std::numeric_limits<double>::infinity();  ///< [N/m] or [N·m/rad], > 0
  bool rotation = false;  ///< true: restrains the rotation; false: the deflection
};

struct Defects {
  std::vector<Damage> damages = {};
  std::vector<SpringSupport> supports = {};
};

}  // namespace wheeltap::fem
