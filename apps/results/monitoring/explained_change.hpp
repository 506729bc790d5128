// Explanations of the changes of a monitored structure, for the summary and as sentences.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/monitoring/causes/change_explanation.hpp"

namespace wheeltap::apps {

/// One explanation per alarm; empty if the case has no structure. The reanalysis for all locations
/// and severities takes about a second.
[[nodiscard]] std::vector<identification::monitoring::ChangeExplanation> explanations(
    const MonitorCaseFile& parsed, const identification::monitoring::Monitor& monitor, int threads);

/// Adds the explanations to /monitor/alarms. Adds /monitor/probability_damage,
/// /monitor/probability_other and /damage for the last alarm.
void add_explanations(const MonitorCaseFile& parsed,
                      const std::vector<identification::monitoring::ChangeExplanation>& explained,
                      Report& summary);

/// The sentence "Cause: damage 93 %, …", and sentences on location and severity; empty for an alarm
/// without an explanation.
[[nodiscard]] std::vector<std::string> explanation_in_words(const Report& alarm);

}  // namespace wheeltap::apps
