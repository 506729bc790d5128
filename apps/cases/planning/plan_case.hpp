// A plan: a damage case without data, and the test to plan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cases/damage_case.hpp"
#include "identification/planning/plan.hpp"

namespace wheeltap::apps {

struct PlanCaseFile {
  DamageCaseFile parsed;
  identification::planning::PlanCase plan;
  /// The candidate sensors, in the format of data.sensors in a damage case.
  std::vector<Json> sensors = {};
  /// Locations [m] on the drawing and directions of the candidate sensors; empty for a structure
  /// given by matrices.
  struct Drawn {
    fem::Vector3 at = {}, direction = {};
  };
  std::vector<std::optional<Drawn>> drawn = {};

  /// Throws Failure with the message of the library's error and its location in the case.
  [[noreturn]] void refuse(const identification::InvalidInput& error) const;
};

/// Parses a damage case with the key "plan"; ignores "data" and "baseline". Throws Failure.
[[nodiscard]] PlanCaseFile parse_plan_case(CaseFile file);

}  // namespace wheeltap::apps
