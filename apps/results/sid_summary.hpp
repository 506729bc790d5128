// summary.json of a system-identification run.
#pragma once

#include "apps/cases/sid_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Returns summary.json. `problem` is that of the run: its case has the time steps used.
[[nodiscard]] Report sid_summary(const SidCaseFile& parsed,
                                 const identification::SidProblem& problem,
                                 const identification::SidFindings& findings, const RunInfo& info);

/// Returns [{"model", "against", "log_bayes_factor", "mcse", "basis", "never_visited"}, …].
[[nodiscard]] Report bayes_factors_report(const identification::SidFindings& findings);

/// Returns {model: [{"channel", "mass", "mse", …}, …], …} at the means of the models' parameters.
[[nodiscard]] Report fits_report(const identification::SidFindings& findings);

/// Returns the one of the two models that has no draws: its name, "both", or "".
[[nodiscard]] std::string never_visited(const identification::SidFindings& findings,
                                        const identification::BayesFactor& factor);

}  // namespace wheeltap::apps
