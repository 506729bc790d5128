// A plan from its case to the files in its folder.
#pragma once

#include <functional>

#include "apps/cases/planning/plan_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// The results of a plan.
struct PlanRun {
  Report summary;
  Report damage_case;  ///< for the recommended design

  /// Writes summary.json, damage.json and report.html as if at once. Throws io::FileError.
  void keep(const std::filesystem::path& folder) const;
};

struct PlanRunOptions {
  int scenarios = 100'000;  ///< simulated tests of the best designs
  int checks = 10;          ///< simulated tests that quick runs of the full engine identify
  /// Receives the stage and its done fraction.
  std::function<void(const char*, double)> progress = {};
};

/// Throws Failure.
[[nodiscard]] PlanRun run_plan(const PlanCaseFile& parsed, const CommonOptions& common,
                               const PlanRunOptions& options);

}  // namespace wheeltap::apps
