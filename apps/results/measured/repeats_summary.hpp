// Repeated tests in summary.json.
#pragma once

#include "apps/report_json.hpp"
#include "identification/structural/observed_states.hpp"

namespace wheeltap::apps {

/// Returns "repeats" of a summary: "tests", "identified" (number of tests with the mode),
/// "mean_hz", "mean_sd_hz", "scatter" (coefficient of variation of one test, per mode),
/// "scatter_sd", "correlation", "degrees_of_freedom" (possible values and their posterior
/// probabilities), "outliers" (test numbers, from 1), "weights", "serial_correlation" and
/// "independent_tests". With several states, "scatter" and "identified" list the modes of all
/// states, and "states" has one object for each state that was tested repeatedly. Returns null
/// without repeated tests. `data` and `states` may be null.
[[nodiscard]] Report repeats_report(const identification::ModalData* data,
                                    const identification::ObservedStates* states);

}  // namespace wheeltap::apps
