// summary.json of a system-identification run.
#pragma once

#include "apps/cases/sid_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Returns the content of summary.json. `problem` is the problem of the run, whose case has the
/// time steps of the run.
[[nodiscard]] Report sid_summary(const SidCaseFile& parsed,
                                 const identification::SidProblem& problem,
                                 const identification::SidFindings& findings, const RunInfo& info);

/// Returns the Bayes factors as JSON: [{"model", "against", "log_bayes_factor", "mcse", "basis",
/// "never_visited"}, …].
[[nodiscard]] Report bayes_factors_report(const identification::SidFindings& findings);

/// Returns the fits at the posterior means of each model's parameters: {model: [{"channel", "mass",
/// "mse", …}, …], …}.
[[nodiscard]] Report fits_report(const identification::SidFindings& findings);

/// Returns the name of the model without draws in a Bayes factor. Returns "both" if neither model
/// has draws, and "" if both models have draws.
[[nodiscard]] std::string never_visited(const identification::SidFindings& findings,
                                        const identification::BayesFactor& factor);

}  // namespace wheeltap::apps
