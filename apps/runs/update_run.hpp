// An update from its case to what was found, wherever that goes.
#pragma once

#include <memory>
#include <optional>

#include "apps/cases/update_case.hpp"
#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/run_watch.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::apps {

/// Of what comes before anything is known of the likelihood: solutions for the basis.
[[nodiscard]] RunCost cost_of_basis(const UpdateCaseFile& parsed);
/// Of a run whose likelihood is a model's of someone else's, before that is asked for anything.
[[nodiscard]] RunCost cost_of_outside(const UpdateCaseFile& parsed, const CommonOptions& common,
                                      const SamplingOptions& options);
/// Of the draws.
[[nodiscard]] RunCost cost_of_update(const identification::UpdateProblem& problem,
                                     const CommonOptions& common, const SamplingOptions& options);

/// Trains the reduced basis, or opens the predictor of one's own and trains what stands in front of
/// it. Throws Failure, io::FileError, OutsideModelError.
[[nodiscard]] std::shared_ptr<const identification::UpdateProblem> prepare_update(
    const UpdateCaseFile& parsed, const CommonOptions& common, RunWatch& watch);

/// None on ranks but the first. Throws as the watch does.
[[nodiscard]] std::optional<FinishedRun> sample_update(
    std::shared_ptr<const UpdateCaseFile> parsed,
    std::shared_ptr<const identification::UpdateProblem> problem, const CommonOptions& common,
    const SamplingOptions& options, RunWatch& watch);

}  // namespace wheeltap::apps
