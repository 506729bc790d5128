// A joint, or a rotational support, that has come loose.
#pragma once

#include <cmath>

#include "identification/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kJoint = {
    .name = "joint",
    .noun = "loose joint",
    .severity = "reduction",
    .severity_words = "stiffness lost",
    .effect_words = "stiffness reduced by",
    .percent = true,
    .lower = 0.0,
    .upper = std::nextafter(1.0, 0.0),
    .bounds_words = "a reduction lies in [0, 1): 0 is intact, 1 would be a hinge",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place_in_structure =
        [](const DefectKind&, const SiteLine::Spot& spot, double severity, StructureEffects& out) {
          out.defects.joints.push_back({spot.site, severity});
        },
    .sites = DefectType::Sites::nodes};

}  // namespace wheeltap::identification::defects
