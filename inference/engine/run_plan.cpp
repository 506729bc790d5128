#include "inference/engine/run_plan.hpp"

#include <algorithm>
#include <cmath>

#include "inference/engine/run_context.hpp"
#include "inference/exploration/model_exploration.hpp"

namespace wheeltap::inference {
namespace {

// Numbers counted for the example cases and the test problems (docs/scale.md).
constexpr double kCallsAClimb = 40.0, kCallsAClimbAndDimension = 12.0;
constexpr double kWeighingRounds = 3.0;
constexpr double kStagesADimension = 2.0, kStages = 4.0;  // stages of SMC
constexpr double kCallsAParticle = 12.0;                  // in each stage
constexpr double kScans = 800.0, kQuickScans = 60.0, kRungs = 10.0, kStepsOfAScan = 3.0;
constexpr double kSettlingSteps = 500.0;
constexpr double kShortRecords = 0.25;  // mean run time of a call in exploration / for the record
constexpr double kSearchedSets = 12.0;  // most models of component sets that are searched

struct Sizes {
  double models = 0.0;      // number of models with parameters and a prior probability
  double dimensions = 0.0;  // sum over these models
  double in_draws = 0.0;    // draws of all models in a round of importance sampling
};

Sizes sizes_of(const ModelSpace& space) {
  Sizes out;
  for (int m = 0; m < space.size(); ++m) {
    const double d = space[m].dimension;
    if (d == 0.0 || !std::isfinite(space[m].log_prior)) continue;
    out.models += 1.0;
    out.dimensions += d;
    out.in_draws += std::clamp(200.0 * d, 1000.0, 4000.0);
  }
  return out;
}

double brevity(const Options& options) {
  return options.warmup > 0 ? std::min(1.0, options.warmup / 20000.0) : 1.0;
}

}  // namespace

Options quick_options(Options options) {
  constexpr int kClimbs = 16, kWarmup = 600, kDraws = 300;
  if (options.searches == 0) options.searches = kClimbs;
  if (options.warmup == 0) options.warmup = kWarmup;
  if (options.draws == 0) options.draws = kDraws;
  if (options.thin == 0) options.thin = 1;
  return options;
}

double planned_searches(const Problem& problem, const Options& options) {
  const Sizes all = sizes_of(problem.space);
  const bool sets = !problem.space.kinds().empty();
  const double share =
      sets && all.models > kSearchedSets ? kSearchedSets / std::max(1.0, all.models) : 1.0;
  const double d = all.models > 0.0 ? all.dimensions / all.models : 0.0;
  double search = 0.0;
  if (options.searches > 0) {
    search = options.searches * all.models * (kCallsAClimb + kCallsAClimbAndDimension * d);
  } else {
    const double budget = problem.shortened ? 50'000.0 : problem.costly ? 100'000.0 : 300'000.0;
    search = std::max(3000.0 * all.models, brevity(options) * budget);
  }
  return share * (search + kWeighingRounds * all.in_draws);
}

RunPlan plan_of(const Problem& problem, const Options& asked) {
  const Options options = asked.quick ? quick_options(asked) : asked;
  const double chains = options.chains;
  const bool sets = !problem.space.kinds().empty();
  RunPlan plan;
  const auto tempering = [&] {
    const double scans =
        options.warmup > 0 ? std::max(kQuickScans, options.warmup / (2.0 * kRungs * kStepsOfAScan))
                           : kScans;
    return scans * kRungs * kStepsOfAScan * chains;
  };
  if (options.prior_only) {
    plan.explore = tempering();
  } else {
    plan.explore = planned_searches(problem, options);
    if (sets) plan.explore += tempering();
    if (!sets && !options.quick && problem.space.size() <= kFewModels) {
      const Sizes all = sizes_of(problem.space);
      const double particles = scaled_particles(
          annealing_particles(problem, brevity(options), static_cast<double>(all.models)),
          static_cast<int>(all.dimensions / std::max(1.0, static_cast<double>(all.models))));
      const double stages = kStages * all.models + kStagesADimension * all.dimensions;
      plan.explore += particles * stages * kCallsAParticle + kWeighingRounds * all.in_draws;
    }
  }
  plan.explore_on_all_data = (problem.shortened ? kShortRecords : 1.0) * plan.explore;
  const double tuned = options.warmup > 0 ? 0.5 * options.warmup : tuning_steps(problem, options);
  plan.tune =
      chains * (tuned + std::min(kSettlingSteps, options.warmup > 0 ? options.warmup : 1e9));
  const double draws = first_draws(problem, options);
  plan.sample = chains * draws * (options.thin > 0 ? options.thin : default_thin(problem, options));
  if (!options.prior_only && options.evidences && problem.space.size() <= kFewModels)
    plan.evidence = problem.space.size() * (options.quick ? kQuickDraws : kEvidenceDraws);
  return plan;
}

}  // namespace wheeltap::inference
