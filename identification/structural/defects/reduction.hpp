// Stiffness reduction: EI and κGA of the element at x are multiplied by 1 - r. In a structure, all
// stiffnesses of the element are multiplied by 1 - r, and the reduction may cover a given length
// instead of an element.
#pragma once

#include "identification/structural/defects/lost_share.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kReduction = [] {
  DefectType type =
      lost_share("reduction", "damage", "a reduction lies in [0, 1): 0 is intact, 1 is broken");
  type.place = [](const DefectKind&, double location, double severity, fem::Defects& out) {
    out.damages.push_back({location, severity});
  };
  type.place_in_structure = [](const DefectKind&, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    if (spot.extent > 0.0) {
      out.defects.reductions.push_back({.member = spot.site,
                                        .from = spot.s - 0.5 * spot.extent,
                                        .to = spot.s + 0.5 * spot.extent,
                                        .reduction = severity});
    } else {
      out.defects.elements.push_back({spot.site, spot.s, severity});
    }
  };
  type.is_elementary = true;
  type.compounds = true;
  return type;
}();

}  // namespace wheeltap::identification::defects
