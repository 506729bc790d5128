// Lost stiffness: the element that contains x keeps (1 - r) of its EI and κGA; in a structure of
// its other stiffnesses, too, or over a stated length.
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
    .place_in_structure =
        [](const DefectKind& kind, const SiteLine::Spot& spot, double severity,
           StructureEffects& out) {
          if (kind.extent) {
            out.defects.reductions.push_back({.member = spot.site,
                                              .from = spot.s - 0.5 * *kind.extent,
                                              .to = spot.s + 0.5 * *kind.extent,
                                              .reduction = severity});
          } else {
            out.defects.elements.push_back({spot.site, spot.s, severity});
          }
        },
    .is_elementary = true,
    .compounds = true};

}  // namespace wheeltap::identification::defects
