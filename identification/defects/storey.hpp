// Lost stiffness of a chain's link: a soft storey.
#pragma once

#include <cmath>

#include "identification/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kStorey = {
    .name = "storey",
    .noun = "soft storey",
    .several = "soft storeys",
    .severity = "reduction",
    .severity_words = "stiffness lost",
    .effect_words = "stiffness reduced by",
    .percent = true,
    .lower = 0.0,
    .upper = std::nextafter(1.0, 0.0),
    .bounds_words = "a reduction lies in [0, 1): 0 is intact, 1 would be broken",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place_in_structure =
        [](const DefectKind&, const SiteLine::Spot& spot, double severity, StructureEffects& out) {
          out.change.softenings.push_back({{{spot.site, 1.0}}, 1.0 - severity});
        },
    .sites = DefectType::Sites::links};

}  // namespace wheeltap::identification::defects
