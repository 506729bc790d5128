#include "identification/structural/defects/placed_defect.hpp"

#include <algorithm>
#include <utility>

#include "fem/structures/defects/structure_defects.hpp"

namespace wheeltap::identification {

fem::StructureChange structure_change(const std::vector<DefectKind>& kinds,
                                      const std::vector<PlacedDefect>& defects,
                                      const fem::Mesh* mesh) {
  StructureEffects effects;
  for (const PlacedDefect& d : defects) {
    const DefectKind& kind = kinds[static_cast<std::size_t>(d.kind)];
    SiteLine::Spot spot = kind.line.spot(d.location);
    spot.extent = kind.extent.value_or(d.extent);
    if (kind.line.is_beam()) {  // member between supports
      while (spot.site + 1 < static_cast<int>(mesh->structure().members.size()) &&
             spot.s >= mesh->member_length(spot.site)) {
        spot.s -= mesh->member_length(spot.site++);
      }
      spot.s = std::min(spot.s, mesh->member_length(spot.site));
    }
    kind.type->place_in_structure(kind, spot, d.severity, effects);
  }
  if (mesh != nullptr) {
    return fem::change_of(*mesh, effects.defects, std::move(effects.change));
  }
  fem::compound(effects.change);
  return std::move(effects.change);
}

void place_in_beam(const std::vector<DefectKind>& kinds, const std::vector<PlacedDefect>& defects,
                   fem::Defects& out) {
  out.damages.clear();
  out.supports.clear();
  for (const PlacedDefect& defect : defects) {
    const DefectKind& kind = kinds[static_cast<std::size_t>(defect.kind)];
    kind.type->place(kind, defect.location, defect.severity, out);
  }
}

}  // namespace wheeltap::identification
