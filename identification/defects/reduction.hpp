// Lost stiffness: the element that contains x keeps (1 - r) of its EI and κGA.
#pragma once

#include <cmath>

#include "identification/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kReduction = {
    .name = "reduction",
    .noun = "damage",
    .severity = "reduction",
    .severity_words = "stiffness lost",
    .effect_words = "stiffness reduced by",
    .percent = true,
    .lower = 0.0,
    .upper = std::nextafter(1.0, 0.0),
    .bounds_words = "a reduction lies in [0, 1): 0 is intact, 1 would be broken",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place =
        [](const DefectKind&, double location, double severity, fem::Defects& out) {
          out.damages.push_back({location, severity});
        },
    .is_elementary = true,
    .compounds = true};

}  // namespace wheeltap::identification::defects
