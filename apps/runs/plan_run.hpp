// A planning run of a case, and its result files.
#pragma once

#include <functional>

#include "apps/cases/planning/plan_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// The results of a plan.
struct PlanRun {
  Report summary;
  Report damage_case;  ///< damage case with the sensors of the recommended design

  /// Writes summary.json, damage.json and report.html as one transaction. Throws io::FileError.
  void keep(const std::filesystem::path& folder) const;
};

struct PlanRunOptions {
  int scenarios = 100'000;  ///< number of simulated tests for the ten best designs
  int checks = 10;          ///< number of simulated tests that quick runs of the engine analyse
  /// Callback that receives the stage and its completed fraction.
  std::function<void(const char*, double)> progress = {};
};

/// check_plan_case checks a case before its run. run_plan makes the plan of the case. Both throw
/// Failure.
void check_plan_case(const PlanCaseFile& parsed, int scenarios);

[[nodiscard]] PlanRun run_plan(const PlanCaseFile& parsed, const CommonOptions& common,
                               const PlanRunOptions& options);

}  // namespace wheeltap::apps
