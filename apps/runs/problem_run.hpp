// A run of a problem that is nobody's case: models, priors and a likelihood that a program brings.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_watch.hpp"

namespace wheeltap::apps {

/// The problem as JSON, by the schema "sample". The same name in two models is the same parameter,
/// with the same prior.
struct ProblemFile {
  CaseFile file;
  std::string title;
  std::shared_ptr<const inference::ModelSpace> space;
};
/// Throws Failure.
[[nodiscard]] ProblemFile parse_problem(CaseFile file);

/// A parameter that was sampled by its probability u ~ U(0, 1): the quantiles x(u) of many, in
/// place.
struct QuantilePrior {
  std::string name;
  std::function<void(std::vector<double>& u)> quantiles;
};

/// Samples and judges; its summary has "answer", "models", "parameters", "priors", "diagnostics"
/// and "cost". `problem` has the space of `parsed`. Throws as the watch does.
[[nodiscard]] FinishedRun sample_problem(std::shared_ptr<const ProblemFile> parsed,
                                         const inference::Problem& problem,
                                         const CommonOptions& common,
                                         const SamplingOptions& options, RunWatch& watch,
                                         const std::vector<QuantilePrior>& by_quantiles = {});

}  // namespace wheeltap::apps
