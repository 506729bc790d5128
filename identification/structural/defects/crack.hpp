// An open edge crack in a member, modelled as a rotational spring by fracture mechanics.
#pragma once

#include <cmath>

#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification::defects {

inline const DefectType kCrack = {
    .name = "crack",
    .noun = "crack",
    .severity = "depth",
    .severity_words = "depth a/h",
    .effect_words = "depth a/h",
    .percent = true,
    .lower = 0.0,
    .upper = std::nextafter(1.0, 0.0),
    .bounds_words = "a depth ratio a/h lies in [0, 1)",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place_in_structure =
        [](const DefectKind& kind, const SiteLine::Spot& spot, double severity,
           StructureEffects& out) {
          out.defects.cracks.push_back({spot.site, spot.s, severity, kind.crack_law});
        },
    .sites = DefectType::Sites::members};

}  // namespace wheeltap::identification::defects
