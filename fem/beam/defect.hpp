// What may be wrong with a beam: lost stiffness in an element, or an extra support.
#pragma once

#include <limits>
#include <vector>

namespace wheeltap::fem {

/// The element containing `location` keeps 1 - `reduction` of its bending and shear stiffness.
/// Damages in one element compound: (1 - r1)(1 - r2).
struct Damage {
  double location;   ///< x [m] in [0, L]
  double reduction;  ///< r [-] in [0, 1)
};

/// A spring to ground at `location`, acting through the element's shape functions. An infinite
/// stiffness is a rigid support.
struct SpringSupport {
  double location;                                             ///< x [m] in [0, L]
  double stiffness = std::numeric_limits<double>::infinity();  ///< [N/m] or [N·m/rad], > 0
  bool rotation = false;  ///< holds the rotation, not the deflection
};

struct Defects {
  std::vector<Damage> damages = {};
  std::vector<SpringSupport> supports = {};
};

}  // namespace wheeltap::fem
