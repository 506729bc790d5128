// Results of a plan: summary.json, the recommended damage case, and what the terminal shows.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apps/cases/planning/plan_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/planning/engine_check.hpp"

namespace wheeltap::apps {

/// summary.json: about the run, and /plan. `check`: without tests if it was not made.
[[nodiscard]] Report plan_summary(const PlanCaseFile& parsed,
                                  const identification::planning::PlanFindings& findings,
                                  const identification::planning::EngineCheck& check,
                                  const RunInfo& info);

/// The damage case of the recommended design. Its truth simulates the test of a damage that the
/// test finds with probability 0.9 (or of the largest one), at the place where this is hardest but
/// possible; measured modes replace it.
[[nodiscard]] Report recommended_case(const PlanCaseFile& parsed,
                                      const identification::planning::PlanFindings& findings);

/// The answer and the tables.
void print_plan(std::ostream& out, const Report& summary, bool colour);

// ---- Sentences, from /plan of a summary

/// The damages that the recommended design detects.
[[nodiscard]] std::string plan_headline(const Report& plan);
/// On sensors, frequencies alone, places that cannot be told apart and what separates them, and the
/// further sensors.
[[nodiscard]] std::vector<std::string> plan_details(const Report& plan);
/// On the check by the full engine; empty without one.
[[nodiscard]] std::string check_sentence(const Report& plan);
/// On costs; empty without costs.
[[nodiscard]] std::vector<std::string> value_sentences(const Report& plan);
/// "0.2 m and 0.7 m"; "no sensors".
[[nodiscard]] std::string sensors_in_words(const Report& plan, const Report& design);

}  // namespace wheeltap::apps
