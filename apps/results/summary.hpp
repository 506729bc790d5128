// What a run found, as the JSON of summary.json: the part that does not know what the models mean.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "apps/words.hpp"
#include "identification/findings/findings.hpp"

namespace wheeltap::apps {

/// What the user asked for, to be repeated.
struct RunInfo {
  std::uint64_t seed = 1;
  std::string command_line;
};

/// {"mean", "sd", "q2.5", "q50", "q97.5", "mode", "ess_bulk", "ess_tail", "rhat"}.
[[nodiscard]] Report json(const identification::Marginal& estimate);

/// {"mean", "sd", "q2.5", "q5", "q50", "q95", "q97.5"} of a further window, "whole": the same of
/// what ever longer records would give, "scatter", "use": "windows" or "run", and "windows": what
/// each of them said.
[[nodiscard]] Report json(const identification::BetweenWindows& between);

/// {label: estimate, …}, an estimate with its "between_windows" where windows were asked for.
[[nodiscard]] Report json(const std::vector<identification::ParameterFinding>& parameters);

/// One row a model: name, prior, probability and its Monte Carlo standard error, and what both rest
/// on: "visited" (chains that drew it), "proposed" and "entered" (jumps into it), "log_evidence"
/// and "log_evidence_se", "basis" ("draws" or "evidence"), "told": a sentence where draws cannot
/// speak for it. `mcse` is null where nothing is known.
[[nodiscard]] Report model_table(const identification::Findings& findings);

/// Estimates of every visited model that is told of in full (told_in_full), as everything is that
/// a summary keeps by model beside its table.
[[nodiscard]] Report parameter_tables(const identification::Findings& findings);

/// Convergence, acceptance and mixing between models.
[[nodiscard]] Report diagnostics(const identification::Findings& findings,
                                 const std::vector<std::string>& warnings);

/// {"tmcmc": [{"model", "log_evidence", "standard_error", "log_bayes_factor", "probability", …},
/// …], …}.
/// Whether the models explain the data: {ok, r2, p, why}.
[[nodiscard]] Report fit_report(const identification::FitVerdict& verdict);
[[nodiscard]] Report evidence_report(const identification::Findings& findings);

/// What repeats the run: version, command, seed, machine and case.
[[nodiscard]] Report about(const std::string& command, const RunInfo& info, const CaseFile& file);

/// Processor and number of cores, in words; nothing that tells one machine of its kind from
/// another.
[[nodiscard]] std::string machine();

/// What the run cost.
[[nodiscard]] Report cost(const identification::Sampling& sampling);

}  // namespace wheeltap::apps
