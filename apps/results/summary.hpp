// Parts of summary.json that all kinds of runs share.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "apps/words.hpp"
#include "identification/findings/findings.hpp"

namespace wheeltap::apps {

/// Seed and command line of a run, from which the run can be repeated.
struct RunInfo {
  std::uint64_t seed = 1;
  std::string command_line;
};

/// Returns a marginal as JSON: {"mean", "sd", "q2.5", "q50", "q97.5", "mode", "ess_bulk",
/// "ess_tail", "rhat"}.
[[nodiscard]] Report json(const identification::Marginal& estimate);

/// Returns the estimates of a parameter from windows as JSON. "mean", "sd", "q2.5", "q5", "q50",
/// "q95" and "q97.5" describe the predictive distribution of the estimate from a further window.
/// "whole" has the same keys, for the value that the estimate approaches in long records. The other
/// keys are "scatter", "use" ("windows" or "run") and "windows" (the value of each window).
[[nodiscard]] Report json(const identification::BetweenWindows& between);

/// Returns the parameter estimates as {label: estimate, …}, with "between_windows" if the case
/// requests windows.
[[nodiscard]] Report json(const std::vector<identification::ParameterFinding>& parameters);

/// Returns one row per model. The row has name, prior, probability and the Monte Carlo standard
/// error of the probability (`mcse`, null if unknown). Further keys state the basis of the
/// probability: "visited" (number of chains with draws of the model), "proposed" and "entered"
/// (jumps into the model), "log_evidence" and "log_evidence_se", "basis" ("draws" or "evidence"),
/// "told" (a sentence, if the probability does not come from draws).
[[nodiscard]] Report model_table(const identification::Findings& findings);

/// Returns the parameter estimates of models with draws. The result contains only the models that
/// the summary describes in full (told_in_full).
[[nodiscard]] Report parameter_tables(const identification::Findings& findings);

/// Returns convergence, acceptance and mixing between models.
[[nodiscard]] Report diagnostics(const identification::Findings& findings,
                                 const std::vector<std::string>& warnings);

/// Returns the verdict on whether the models explain the data: {ok, r2, p, why}.
[[nodiscard]] Report fit_report(const identification::FitVerdict& verdict);
/// Returns the evidences as JSON: {"tmcmc": [{"model", "log_evidence", "standard_error",
/// "log_bayes_factor", "probability", …}, …], …}.
[[nodiscard]] Report evidence_report(const identification::Findings& findings);

/// Returns the data with which the run can be repeated: version, command, seed, machine and case.
[[nodiscard]] Report about(const std::string& command, const RunInfo& info, const CaseFile& file);

/// Returns a description of processor and number of cores, without information that identifies a
/// single machine.
[[nodiscard]] std::string machine();

/// Returns the cost of the run: evaluations, time, draws.
[[nodiscard]] Report cost(const identification::Sampling& sampling);

}  // namespace wheeltap::apps
