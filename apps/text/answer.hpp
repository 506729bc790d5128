// What a run found, in the two sentences that people read first.
#pragma once

#include <string>
#include <vector>

#include "apps/report_json.hpp"
#include "identification/sid/findings/sid_findings.hpp"
#include "identification/structural/damage/damage_findings.hpp"

namespace wheeltap::apps {

struct Answer {
  std::string caution;  ///< empty, or why the rest cannot be trusted yet
  /// How many, or which model, with its probability; before it, where the models do not explain the
  /// data, that they do not.
  std::string headline;
  std::string detail;   ///< where and how bad, with 95 % intervals; may be empty
  bool misfit = false;  ///< the headline begins with that the models do not explain the data
};

/// Why a run's numbers cannot be trusted yet; empty where they can.
[[nodiscard]] std::string caution(const identification::Findings& findings);

/// How many damages. A count (a model) is "most likely" from a probability of 0.6; below, the run
/// is undecided and all with 10 % or more are named. A location whose 95 % interval covers more
/// than a quarter of the beam is not called located.
[[nodiscard]] Answer answer(const identification::DamageCase& damage_case,
                            const identification::DamageFindings& findings);

/// Which equation of motion.
[[nodiscard]] Answer answer(const identification::Findings& findings);
/// The same; of a discovery, which terms.
[[nodiscard]] Answer answer(const identification::SidFindings& findings);

/// One run of a sweep.
struct SweepRow {
  std::string value;
  std::vector<identification::ModelFinding> models;
  bool converged = false;
  bool explained = true;  ///< by one of the models
};
/// Which model is the most probable, and where along the values that changes.
[[nodiscard]] Answer answer(const std::string& path, const std::vector<SweepRow>& rows);

[[nodiscard]] Report json(const Answer& answer);
/// What a summary keeps of it. A summary from before answers were kept has the models named, and no
/// detail.
[[nodiscard]] Answer read_answer(const Report& summary);

}  // namespace wheeltap::apps
