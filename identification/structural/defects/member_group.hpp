// Stiffness reduction of a named group of members, such as the columns of a storey or a chord.
#pragma once

#include <limits>

#include "identification/structural/defects/lost_share.hpp"

namespace wheeltap::identification::defects {

/// All stiffnesses of all members in the group are multiplied by 1 - r. The key in a case is
/// "substructure", as for parts of matrices from another program.
inline const DefectType kMemberGroup = [] {
  DefectType type = lost_share("substructure", "soft substructure",
                               "a reduction lies in [0, 1): 0 is intact, 1 has no stiffness");
  type.place_in_structure = [](const DefectKind& kind, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    for (const int member : kind.groups[static_cast<std::size_t>(spot.site)])
      out.defects.reductions.push_back({.member = member,
                                        .from = 0.0,
                                        .to = std::numeric_limits<double>::infinity(),
                                        .reduction = severity});
  };
  type.sites = DefectType::Sites::substructures;
  return type;
}();

}  // namespace wheeltap::identification::defects
