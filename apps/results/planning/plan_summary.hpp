// Results of a plan: summary.json, the damage case with the recommended sensors, and the terminal
// text.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apps/cases/planning/plan_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/planning/engine_check.hpp"

namespace wheeltap::apps {

/// Content of summary.json: information about the run, and /plan. `check.tests` is empty if no
/// check was made.
[[nodiscard]] Report plan_summary(const PlanCaseFile& parsed,
                                  const identification::planning::PlanFindings& findings,
                                  const identification::planning::EngineCheck& check,
                                  const RunInfo& info);

/// A damage case with the sensors of the recommended design. The key `truth` contains one damage.
/// Its location is the location at which the smallest detectable severity (detected with
/// probability 0.9) is largest; its severity is this smallest detectable severity. If the test
/// detects no damage with probability 0.9, the truth is the largest damage at the location with the
/// most detections. After the test, the user replaces the truth by the measured modes.
[[nodiscard]] Report recommended_case(const PlanCaseFile& parsed,
                                      const identification::planning::PlanFindings& findings);

/// Prints the headline, the details and the tables.
void print_plan(std::ostream& out, const Report& summary, bool colour);

// ---- Sentences, from /plan of a summary

/// Sentence on the damage that the recommended design detects.
[[nodiscard]] std::string plan_headline(const Report& plan);
/// Sentences on the sensors, on a test of frequencies only, on indistinguishable locations and
/// design changes that distinguish them, and on further sensors.
[[nodiscard]] std::vector<std::string> plan_details(const Report& plan);
/// Sentence on the check by the full engine; empty without a check.
[[nodiscard]] std::string check_sentence(const Report& plan);
/// Sentences on costs; empty without costs.
[[nodiscard]] std::vector<std::string> value_sentences(const Report& plan);
/// The sensors of a design: "0.2 m and 0.7 m", or "no sensors for shapes".
[[nodiscard]] std::string sensors_in_words(const Report& plan, const Report& design);

}  // namespace wheeltap::apps
