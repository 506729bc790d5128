// A run of a general problem: another program (Python) gives models, priors and a likelihood.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_watch.hpp"

namespace wheeltap::apps {

/// A problem as JSON that satisfies the schema "sample". Parameters with the same name in two
/// models are the same parameter and have one prior.
struct ProblemFile {
  CaseFile file;
  std::string title;
  std::shared_ptr<const inference::ModelSpace> space;
};
/// Parses a problem from JSON. Throws Failure.
[[nodiscard]] ProblemFile parse_problem(CaseFile file);

/// A parameter x whose cumulative probability u is sampled; `quantiles` replaces u by x(u).
struct QuantilePrior {
  std::string name;
  std::function<void(std::vector<double>& u)> quantiles;
};

/// Samples the posterior of a general problem and diagnoses convergence. The summary has "answer",
/// "models", "parameters", "priors", "diagnostics" and "cost". `problem` has the model space of
/// `parsed`. Passes on every exception that `watch` throws.
[[nodiscard]] FinishedRun sample_problem(std::shared_ptr<const ProblemFile> parsed,
                                         const inference::Problem& problem,
                                         const CommonOptions& common,
                                         const SamplingOptions& options, RunWatch& watch,
                                         const std::vector<QuantilePrior>& by_quantiles = {});

}  // namespace wheeltap::apps
