// Stiffness reduction of a whole substructure in matrices of another program.
#pragma once

#include "identification/structural/defects/lost_share.hpp"

namespace wheeltap::identification::defects {

/// Replaces K_j by (1 - r) K_j.
inline const DefectType kSubstructure = [] {
  DefectType type = lost_share("substructure", "soft substructure",
                               "a reduction lies in [0, 1): 0 is intact, 1 has no stiffness");
  type.place_in_structure = [](const DefectKind&, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    out.change.scalings.push_back({.part = spot.site, .remaining = 1.0 - severity});
  };
  type.sites = DefectType::Sites::substructures;
  type.has_low_rank = false;
  return type;
}();

}  // namespace wheeltap::identification::defects
