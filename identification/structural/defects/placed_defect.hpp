// Defects with their locations on the lines of their kinds, and their effect on the structure.
#pragma once

#include <vector>

#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"
#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification {

struct PlacedDefect {
  int kind;
  double location;  ///< position on the line of the kind
  double severity;
  double extent = 0.0;  ///< extent [m], if the extent of the kind is unknown
};

/// Change of the structure that `defects` cause. `mesh` is null for structures without members.
[[nodiscard]] fem::StructureChange structure_change(const std::vector<DefectKind>& kinds,
                                                    const std::vector<PlacedDefect>& defects,
                                                    const fem::Mesh* mesh);

/// Replaces `out` by the defects on a beam. Every type must have `place`.
void place_in_beam(const std::vector<DefectKind>& kinds, const std::vector<PlacedDefect>& defects,
                   fem::Defects& out);

}  // namespace wheeltap::identification
