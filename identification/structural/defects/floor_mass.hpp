// Mass added to one mass of a chain of masses, like the defect type `mass` for a member.
#pragma once

#include <limits>

#include "identification/structural/defects/mass.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kFloorMass = [] {
  DefectType type = kMass;
  type.place = nullptr;
  type.place_in_structure = [](const DefectKind&, const SiteLine::Spot& spot, double severity,
                               StructureEffects& out) {
    out.change.masses.push_back(
        {.motion = {.dofs = {spot.site}, .coefficients = {1.0}}, .mass = severity});
  };
  type.sites = DefectType::Sites::nodes;
  return type;
}();

}  // namespace wheeltap::identification::defects
