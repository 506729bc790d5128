// Beams, frames, portals and buildings of random sizes.
#pragma once

#include <string>
#include <vector>

#include "base/random.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::coverage {

/// Family of a case, and possible places of its defects.
struct RandomStructure {
  std::string family;
  double mass;              ///< mass of all members [kg]; 0 for a building
  std::vector<int> joints;  ///< nodes that may come loose
};

/// Fills in the beam or the structure of a case. Members are steel, rectangular, with a depth
/// of a 15th to a 40th of a beam's length or 0.15 to 0.4 m.
[[nodiscard]] RandomStructure random_structure(base::Random& random,
                                               identification::DamageCase& into);

}  // namespace wheeltap::coverage
