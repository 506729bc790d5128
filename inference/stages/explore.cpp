#include "inference/stages/explore.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "inference/model_exploration.hpp"
#include "inference/stages/model_probabilities.hpp"
#include "inference/stages/temper.hpp"
#include "inference/stages/tune.hpp"
#include "inference/starting_points.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr int kExplorationScans = 1260;  // 20 + 40 + … + 640
constexpr long kLongRecord = 20000;  // samples: exploring from the prior costs more than it finds
constexpr int kManyModels = 3000;    // climbed in
constexpr long kClimbsInMany = 2;    // in each of those
constexpr int kReachedModels = 12;   // of many: those explored by themselves when they are reached
constexpr double kReached = 0.01;    // share of the visits
constexpr long kSearchBudget = 300000;  // likelihood calls for climbs, all models together
constexpr long kRecordBudget = 50000;   // where a record grows: modes are then followed besides
constexpr long kLeastBudget = 3000;     // a model's
constexpr double kBriefAnnealing = 50000.0;  // likelihood calls, a model, about
constexpr double kHopeless = 50.0;           // ln: models this far below the best are not annealed
constexpr double kLive = 30.0;               // ln: chains start in models this far below the best

std::vector<int> every_model(const RunContext& run) {
  std::vector<int> all(run.models());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Of many models, those that matter as far as tempering can tell.
std::vector<int> reached(const RunContext& run, const RunState& state) {
  std::vector<int> list = every_model(run);
  if (run.space().size() <= kFewModels) return list;
  const PilotSamples& cold = state.by_rung.back();
  std::ranges::stable_sort(list, std::ranges::greater{}, [&](int m) { return cold.visits(m); });
  std::erase_if(list, [&](int m) {
    return static_cast<double>(cold.visits(m)) < kReached * static_cast<double>(cold.total());
  });
  if (list.size() > kReachedModels) list.resize(kReachedModels);
  return list;
}

void count(RunContext& run, RunState& state, const ModelExploration& found,
           const ExplorationCalls& before) {
  const long more = found.calls.sum() - before.sum();
  state.shared_evaluations += more;
  state.posterior.calls.search += found.calls.search - before.search;
  state.posterior.calls.anneal += found.calls.anneal - before.anneal;
  state.posterior.calls.weigh += found.calls.weigh - before.weigh;
  run.monitor.evaluated(more);
}

// Each model of the list by itself: all are surveyed before any is annealed, since a hopeless one
// of a record, whose likelihoods are dear, needs no more than a survey.
void explore_each(RunContext& run, RunState& state, const std::vector<int>& list, bool anneal) {
  const Problem& problem = run.problem;
  const auto with_parameters =
      std::ranges::count_if(list, [&](int m) { return problem.space[m].dimension > 0; });
  if (with_parameters == 0 && !anneal) return;
  const double brief = run.options.warmup > 0
                           ? std::min(1.0, static_cast<double>(run.options.warmup) / 20000.0)
                           : 1.0;
  const long budget = std::max(
      kLeastBudget,
      static_cast<long>(brief *
                        static_cast<double>(problem.shortened ? kRecordBudget : kSearchBudget) /
                        static_cast<double>(std::max<long>(1, with_parameters))));
  const auto options = [&](int m) {
    ExplorationOptions how{
        .seed = run.options.seed,
        .climbs = run.options.searches,
        .budget = problem.space.size() > kFewModels ? kLeastBudget : budget,
        .anneal = anneal,
        .particles = static_cast<int>(
            std::clamp(brief * 12000.0 / static_cast<double>(with_parameters + 1), 400.0, 1200.0)),
        .threads = run.options.threads,
        .progress = [&](double share) { return run.monitor.advance(share); }};
    if (!state.by_rung.empty()) how.draws = state.by_rung.back().states(m).transpose();
    return how;
  };
  double best = -kInfinity;
  const auto log_mass = [&](int m) {
    return problem.space[m].log_prior +
           state.explorations[static_cast<std::size_t>(m)].log_evidence();
  };
  const double parts = static_cast<double>(std::max<long>(1, with_parameters));
  const double later = planned_tuning(run) + planned_draws(run) + planned_evidence(run);
  run.monitor.begin("searching", parts, later + (anneal ? kBriefAnnealing * parts : 0.0));
  for (const int m : list) {
    if (!std::isfinite(problem.space[m].log_prior)) continue;
    ModelExploration& found = state.explorations[static_cast<std::size_t>(m)] =
        survey_model(problem, m, options(m));
    count(run, state, found, {});
    best = std::max(best, log_mass(m));
    if (run.monitor.stopped()) return;
  }
  if (!anneal) return;
  run.monitor.begin("annealing", parts, later);
  for (const int m : list) {
    ModelExploration& found = state.explorations[static_cast<std::size_t>(m)];
    if (!std::isfinite(problem.space[m].log_prior) || problem.space[m].dimension == 0) continue;
    const bool hopeless = problem.shortened && log_mass(m) < best - kHopeless;
    if (hopeless && found.settled()) {
      if (!run.monitor.advance(1.0)) return;
      continue;
    }
    const ExplorationCalls before = found.calls;
    anneal_model(problem, m, options(m), hopeless ? Annealing::brief : Annealing::as_needed, found);
    count(run, state, found, before);
    best = std::max(best, log_mass(m));
    if (run.monitor.stopped()) return;
  }
}

// Climbs alone in each of very many models, and a look at those that this makes probable.
void explore_many(RunContext& run, RunState& state) {
  const Problem& problem = run.problem;
  run.monitor.begin("searching", static_cast<double>(run.models()));
  for (const int m : every_model(run)) {
    if (!std::isfinite(problem.space[m].log_prior)) continue;
    ModelExploration& found = state.explorations[static_cast<std::size_t>(m)] =
        explore_model(problem, m,
                      {.seed = run.options.seed,
                       .climbs = run.options.searches > 0 ? run.options.searches : kClimbsInMany,
                       .anneal = false,
                       .climbs_only = true,
                       .threads = run.options.threads});
    count(run, state, found, {});
    if (!run.monitor.advance(1.0)) return;
  }
  estimate_probabilities(run, state);
  const auto probability = [&](int m) { return state.probability[static_cast<std::size_t>(m)]; };
  std::vector<int> probable = every_model(run);
  std::ranges::stable_sort(probable, std::ranges::greater{}, probability);
  probable.resize(kReachedModels);
  std::erase_if(probable, [&](int m) { return probability(m) < kReached; });
  explore_each(run, state, probable, false);
}

// Where a long record makes exploring from the prior cost more than it finds.
void explore_growing(RunContext& run, RunState& state) {
  const std::vector<Laplace> modes = climb_with_record(run.problem, run.options, run.monitor);
  bool any = false;
  for (std::size_t m = 0; m < run.models(); ++m) {
    const Laplace& mode = modes[m];
    state.shared_evaluations += mode.evidence.likelihood_evaluations;
    state.posterior.calls.search += mode.evidence.likelihood_evaluations;
    if (!std::isfinite(mode.evidence.log_evidence)) continue;
    any = true;
    ModelExploration& found = state.explorations[m];
    if (run.space()[static_cast<int>(m)].dimension == 0) {
      found.sampled = mode.evidence;
      found.effective_draws = kInfinity;
      continue;
    }
    found.modes.push_back({.z = mode.z,
                           .log_posterior = kNaN,
                           .covariance = mode.covariance,
                           .log_mass = mode.evidence.log_evidence,
                           .climbs = 1});
    found.shares = {1.0};
    found.climbs = 1;
    const Eigen::MatrixXd factor = Eigen::LLT<Eigen::MatrixXd>(mode.covariance).matrixL();
    base::Random random(run.options.seed, m, 0, base::Purpose::search);
    constexpr Eigen::Index kDraws = 2000;
    found.population.resize(factor.rows(), kDraws);
    Eigen::VectorXd u(factor.rows());
    for (Eigen::Index i = 0; i < kDraws; ++i) {
      for (double& v : u) v = random.normal();
      found.population.col(i) =
          Eigen::Map<const Eigen::VectorXd>(mode.z.data(), factor.rows()) + factor * u;
    }
  }
  if (!any && run.monitor.stopped()) return;
  if (!any) throw LikelihoodError("no model has a mode that a search on growing records finds");
  state.posterior.notes.push_back(
      "The record is long, so the chains were started near modes that were found on its first "
      "samples and followed as it grew.");
}

// Chains start in different models where several are possible, at draws of the populations.
void start_chains(RunContext& run, RunState& state) {
  std::vector<int> live;
  double best = -kInfinity;
  for (const double p : state.log_probability) best = std::max(best, p);
  for (std::size_t m = 0; m < run.models(); ++m)
    if (state.log_probability[m] > best - kLive) live.push_back(static_cast<int>(m));
  run.each_chain(state, [&](int c, ChainState& chain, Target& target) {
    base::Random random(run.options.seed, static_cast<std::uint64_t>(c), 1, base::Purpose::start);
    for (std::size_t attempt = 0; attempt < 20 * live.size(); ++attempt) {
      State start;
      start.model = live[(static_cast<std::size_t>(c) + attempt) % live.size()];
      const Eigen::MatrixXd& population =
          state.explorations[static_cast<std::size_t>(start.model)].population;
      if (run.space()[start.model].dimension > 0) {
        if (population.cols() > 0) {
          const auto column = population.col(random.index(static_cast<int>(population.cols())));
          start.z.assign(column.begin(), column.end());
        } else if (!state.by_rung.empty() && state.by_rung.back().visits(start.model) > 0) {
          const Eigen::MatrixXd states = state.by_rung.back().states(start.model);
          const auto column = states.col(random.index(static_cast<int>(states.cols())));
          start.z.assign(column.begin(), column.end());
        } else {
          continue;
        }
      }
      target.sort_components(start);
      target.evaluate(start);
      if (!std::isfinite(start.log_likelihood)) continue;
      chain.state = std::move(start);
      return;
    }
    chain.state = start_from_prior(target, random);
  });
}

}  // namespace

void explore(RunContext& run, RunState& state) {
  const Problem& problem = run.problem;
  const bool list = problem.space.kinds().empty();
  const bool balanced = problem.space.size() <= kBalancedModels;
  if (run.options.prior_only) {
    temper(run, state, {.scans = kExplorationScans});
    if (run.monitor.stopped()) return;
    pool_ladders(run, state);
    take_prior_probabilities(run, state);
    return fit_proposals(run, state, 0);
  }
  if (list && problem.samples >= kLongRecord && problem.shortened) {
    explore_growing(run, state);
  } else if (list && problem.space.size() <= kFewModels) {
    explore_each(run, state, every_model(run), !run.options.quick);
  } else if (list && problem.space.size() <= kManyModels) {
    explore_many(run, state);
  } else {
    temper(run, state, {.scans = kExplorationScans, .balanced = balanced});
    if (run.monitor.stopped()) return;
    pool_ladders(run, state);
    explore_each(run, state, reached(run, state), false);
  }
  if (run.monitor.stopped()) return;
  estimate_probabilities(run, state);
  start_chains(run, state);
  fit_proposals(run, state, 0);
}

}  // namespace wheeltap::inference
