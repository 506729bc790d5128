// Defects of a structure, each at a place on the line of its kind, and what they do together.
#pragma once

#include <vector>

#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"
#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification {

struct PlacedDefect {
  int kind;
  double location;  ///< on the kind's line
  double severity;
  double extent = 0.0;  ///< [m], where the kind's is unknown
};

/// What they do to the structure. `mesh`: where it is of members.
[[nodiscard]] fem::StructureChange structure_change(const std::vector<DefectKind>& kinds,
                                                    const std::vector<PlacedDefect>& defects,
                                                    const fem::Mesh* mesh);

}  // namespace wheeltap::identification
