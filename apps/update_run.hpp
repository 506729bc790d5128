// An update from its case to what was found, wherever that goes.
#pragma once

#include <memory>

#include "apps/finished_run.hpp"
#include "apps/run_cost.hpp"
#include "apps/run_watch.hpp"
#include "apps/update_case.hpp"
#include "identification/update_problem.hpp"

namespace wheeltap::apps {

/// Of what comes before anything is known of the likelihood: solutions for the basis.
[[nodiscard]] RunCost cost_of_basis(const identification::UpdateCase& update_case);
/// Of the draws.
[[nodiscard]] RunCost cost_of_update(const identification::UpdateProblem& problem,
                                     const CommonOptions& common, const SamplingOptions& options);

/// Trains the reduced basis. Throws Failure.
[[nodiscard]] std::shared_ptr<const identification::UpdateProblem> prepare_update(
    const UpdateCaseFile& parsed, RunWatch& watch);

/// Throws as the watch does.
[[nodiscard]] FinishedRun sample_update(
    std::shared_ptr<const UpdateCaseFile> parsed,
    std::shared_ptr<const identification::UpdateProblem> problem, const CommonOptions& common,
    const SamplingOptions& options, RunWatch& watch);

}  // namespace wheeltap::apps
