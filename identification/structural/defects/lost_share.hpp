// Common properties of defect types whose severity is the lost fraction of the stiffness.
#pragma once

#include <cmath>

#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification::defects {

/// Returns a type whose severity r in [0, 1) is called "reduction"; `bounds_words` explains the
/// upper bound 1. The caller sets all other members.
[[nodiscard]] inline DefectType lost_share(std::string_view name, std::string_view noun,
                                           std::string_view bounds_words) {
  return {.name = name,
          .noun = noun,
          .severity = "reduction",
          .severity_words = "stiffness lost",
          .effect_words = "stiffness reduced by",
          .percent = true,
          .lower = 0.0,
          .upper = std::nextafter(1.0, 0.0),
          .bounds_words = bounds_words,
          .unit = [](const DefectKind&) -> std::string_view { return ""; }};
}

}  // namespace wheeltap::identification::defects
