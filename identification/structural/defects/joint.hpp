// A loose joint or rotational support.
#pragma once

#include "identification/structural/defects/lost_share.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kJoint = [] {
  DefectType type =
      lost_share("joint", "loose joint", "a reduction lies in [0, 1): 0 is intact, 1 is a hinge");
  type.place_in_structure = [](const DefectKind&, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    out.defects.joints.push_back({spot.site, severity});
  };
  type.sites = DefectType::Sites::nodes;
  return type;
}();

}  // namespace wheeltap::identification::defects
