// A damage run from its case to what was found, wherever that goes.
#pragma once

#include <memory>
#include <optional>

#include "apps/cases/damage_case.hpp"
#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_watch.hpp"
#include "identification/structural/damage/damage_problem.hpp"

namespace wheeltap::apps {

/// Trains what predicts, where something is to be trained. Throws Failure.
[[nodiscard]] std::shared_ptr<const identification::DamageProblem> prepare_damage(
    const DamageCaseFile& parsed, const CommonOptions& common, RunWatch& watch);

/// None on ranks but the first. Throws as the watch does.
[[nodiscard]] std::optional<FinishedRun> sample_damage(
    std::shared_ptr<const DamageCaseFile> parsed,
    std::shared_ptr<const identification::DamageProblem> problem, const CommonOptions& common,
    const SamplingOptions& options, RunWatch& watch);

}  // namespace wheeltap::apps
