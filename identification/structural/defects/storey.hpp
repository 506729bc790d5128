// Stiffness reduction of a chain's link: a soft storey.
#pragma once

#include "identification/structural/defects/lost_share.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kStorey = [] {
  DefectType type =
      lost_share("storey", "soft storey", "a reduction lies in [0, 1): 0 is intact, 1 is broken");
  type.several = "soft storeys";
  type.place_in_structure = [](const DefectKind&, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    out.change.softenings.push_back({{{spot.site, 1.0}}, 1.0 - severity});
  };
  type.sites = DefectType::Sites::links;
  return type;
}();

}  // namespace wheeltap::identification::defects
