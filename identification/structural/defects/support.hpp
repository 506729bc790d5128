// An unintended support at x: a spring to ground on the deflection [N/m] or on the rotation [N
// m/rad], or a rigid support.
#pragma once

#include <algorithm>

#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kSupport = {
    .name = "support",
    .noun = "support",
    .severity = "stiffness",
    .severity_words = "stiffness",
    .effect_words = "stiffness",
    .bounds_words = "a spring's stiffness is > 0",
    .may_be_known = true,
    .may_be_rotational = true,
    .unit = [](const DefectKind& kind) -> std::string_view {
      return kind.rotation ? "N m/rad" : "N/m";
    },
    .place =
        [](const DefectKind& kind, double location, double severity, fem::Defects& out) {
          // Draws of priors near 0 may underflow to 0; a spring of 1e-200 N/m has no effect.
          out.supports.push_back({location, std::max(severity, 1e-200), kind.rotation});
        },
    .place_in_structure =
        [](const DefectKind& kind, const SiteLine::Spot& spot, double severity,
           StructureEffects& out) {
          const fem::Direction along = kind.rotation ? fem::Direction::rz : kind.direction;
          out.defects.supports.push_back({spot.site, spot.s, along, std::max(severity, 1e-200)});
        },
    .is_elementary = true};

}  // namespace wheeltap::identification::defects
