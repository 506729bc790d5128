// Mass added to a member; a negative mass is removed from the member.
#pragma once

#include <limits>

#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kMass = {
    .name = "mass",
    .noun = "added mass",
    .several = "added masses",
    .severity = "mass",
    .severity_words = "mass",
    .effect_words = "mass",
    .lower = -std::numeric_limits<double>::infinity(),
    .bounds_words = "a mass is in kg; a lost mass is negative",
    .unit = [](const DefectKind&) -> std::string_view { return "kg"; },
    .place_in_structure =
        [](const DefectKind&, const SiteLine::Spot& spot, double severity, StructureEffects& out) {
          out.defects.masses.push_back({spot.site, spot.s, severity});
        },
    .sites = DefectType::Sites::members};

}  // namespace wheeltap::identification::defects
