// The main result of a run in two sentences, at the beginning of the terminal text and the report.
#pragma once

#include <string>
#include <vector>

#include "apps/report_json.hpp"
#include "identification/sid/findings/sid_findings.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

struct Answer {
  std::string caution;  ///< reason why the results are not reliable yet; may be empty
  /// The number of damages or the model, with its probability. If no model explains the data, the
  /// headline begins with this statement.
  std::string headline;
  std::string detail;   ///< locations, severities or parameters with 95 % intervals; may be empty
  bool misfit = false;  ///< true if no model explains the data; the headline states this
};

/// Returns the reason why the results of a run are not reliable yet; empty if they are reliable.
[[nodiscard]] std::string caution(const identification::Findings& findings);

/// Returns the main result of a damage run. A model (a number of damages) with a probability of at
/// least 0.6 is "most likely". If no model reaches 0.6, the run is undecided, and the headline
/// names all models with at least 10 %. A damage is "not located" if the 95 % credible interval of
/// its location covers more than a quarter of the beam.
[[nodiscard]] Answer answer(const identification::DamageCase& damage_case,
                            const identification::DamageFindings& findings);

/// Returns the most probable equation of motion.
[[nodiscard]] Answer answer(const identification::Findings& findings);
/// Returns the most probable equation of motion or, if the case has terms to select, the terms.
[[nodiscard]] Answer answer(const identification::SidFindings& findings);

/// The result of one run of a sweep.
struct SweepRow {
  std::string value;
  std::vector<identification::ModelFinding> models;
  bool converged = false;
  bool explained = true;  ///< true if one of the models explains the data
};
/// Returns the most probable model for each range of the swept values.
[[nodiscard]] Answer answer(const std::string& path, const std::vector<SweepRow>& rows);

[[nodiscard]] Report json(const Answer& answer);
/// Reads the main result from the key "answer" of a summary. If the summary does not have this key
/// (older versions), the result names the models, without detail.
[[nodiscard]] Answer read_answer(const Report& summary);

}  // namespace wheeltap::apps
