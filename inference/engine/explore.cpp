#include "inference/engine/explore.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "inference/engine/model_probabilities.hpp"
#include "inference/engine/run_plan.hpp"
#include "inference/engine/temper.hpp"
#include "inference/engine/tune.hpp"
#include "inference/exploration/model_exploration.hpp"
#include "inference/exploration/nested_starts.hpp"
#include "inference/exploration/occams_window.hpp"
#include "inference/exploration/starting_points.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kExplorationScans = 1260;  // 20 + 40 + … + 640
constexpr long kLongRecord = 20000;      // samples from which explore_growing is used
constexpr int kManyModels = 3000;        // largest number of models for a search by climbs
constexpr long kClimbsInMany = 2;        // climbs in each of many models
// For a record: number of models of a nested list from which climbs replace SMC. Climbs from the
// modes of nested models find more modes with a tenth of the likelihood evaluations.
constexpr int kManyNested = 8;
constexpr int kSearchedModels = 60;  // largest number of fully searched models among them
constexpr int kSearchRounds = 4;
constexpr std::size_t kNestedStarts = 3;  // nested models whose modes serve as starting points
constexpr std::size_t kReachedModels =
    12;                            // largest number of models searched separately after tempering
constexpr double kReached = 0.01;  // smallest share of the visits for such a search
constexpr long kSearchBudget = 300000;       // likelihood evaluations of the climbs of all models
constexpr long kCostlyBudget = 100000;       // the same for a costly likelihood
constexpr long kRecordBudget = 50000;        // the same for a record, whose modes are followed
constexpr long kLeastBudget = 3000;          // smallest budget per model
constexpr double kBriefAnnealing = 50000.0;  // approximate likelihood evaluations per model
constexpr double kNegligibleModel = 50.0;    // no SMC in models with ln (P Z) below best - 50
constexpr double kLive = 30.0;               // chains start in models with ln P above best - 30

std::vector<int> every_model(const RunContext& run) {
  std::vector<int> all(run.models());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// All of a few models; of many models, those that tempering visits with a share above kReached.
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

// Search effort for a model of a nested list. If the search misses a mode of an improbable model,
// later searches can find it from the modes of related models. Improbable models therefore need
// fewer climbs.
double effort_for(const RunState& state, int m) {
  constexpr double kLeast = 0.2;
  const double p = state.probability[static_cast<std::size_t>(m)];
  return std::clamp(p / kLimits.probable_model, kLeast, 1.0);
}

// Sets the models that explore_each explores next.
void search_next(RunState& state, std::vector<int> models) {
  state.at.explore = Position::Explore::search;
  state.at.models = std::move(models);
  state.at.model = 0;
  state.at.best = -kInfinity;
}

// Explores each model of the list separately. A survey of all models precedes SMC, because
// improbable models need only a survey if the likelihood is that of a record and expensive. In a
// nested list, each model has the full budget, and its climbs also start from the modes of models
// nested in it.
void explore_each(RunContext& run, RunState& state, bool anneal, bool nested = false) {
  const Problem& problem = run.problem;
  Position& at = state.at;
  const std::vector<int>& list = at.models;
  const auto with_parameters =
      std::ranges::count_if(list, [&](int m) { return problem.space[m].dimension > 0; });
  if (with_parameters == 0 && !anneal) return;
  const double brief = run.options.warmup > 0
                           ? std::min(1.0, static_cast<double>(run.options.warmup) / 20000.0)
                           : 1.0;
  const long budget = std::max(
      kLeastBudget,
      static_cast<long>(brief *
                        static_cast<double>(problem.shortened ? kRecordBudget
                                            : problem.costly  ? kCostlyBudget
                                                              : kSearchBudget) /
                        static_cast<double>(nested ? 1 : std::max<long>(1, with_parameters))));
  const auto options = [&](int m) {
    ExplorationOptions how{
        .seed = run.options.seed,
        .climbs = run.options.searches,
        .budget = problem.space.size() > kFewModels && !nested ? kLeastBudget : budget,
        .effort = nested ? effort_for(state, m) : 1.0,
        .anneal = anneal,
        .particles = annealing_particles(problem, brief, static_cast<double>(with_parameters)),
        .threads = run.options.threads,
        .progress = [&](double share) { return run.monitor.advance(share); },
        .stop = [&] { return run.monitor.stopped(); }};
    if (!run.options.evidences) {
      how.rounds = 3;
      how.climbs_from_draws = 2;
    }
    if (!state.by_rung.empty()) how.draws = state.by_rung.back().states(m).transpose();
    if (nested) how.starts = nested_starts(problem.space, m, state.explorations, kNestedStarts);
    // Starts also from the modes of earlier climbs, so that this search need not find them again.
    for (const Mode& mode : state.explorations[static_cast<std::size_t>(m)].modes)
      how.starts.push_back(mode.z);
    return how;
  };
  const auto log_mass = [&](int m) {
    return problem.space[m].log_prior +
           state.explorations[static_cast<std::size_t>(m)].log_evidence();
  };
  const double parts = static_cast<double>(std::max<long>(1, with_parameters));
  const double later = planned_tuning(run) + planned_draws(run) + planned_evidence(run);
  // Calls body(m) for the remaining models, with safe points in between; false if stopped.
  const auto each_left = [&](auto&& body) {
    for (; at.model < static_cast<int>(list.size()); ++at.model) {
      run.safe_points.pass(state);
      body(list[static_cast<std::size_t>(at.model)]);
      if (run.monitor.stopped()) return false;
    }
    return true;
  };
  const auto survey = [&](int m) {
    if (!std::isfinite(problem.space[m].log_prior) || is_impossible(state, m)) return;
    ModelExploration& found = state.explorations[static_cast<std::size_t>(m)] =
        survey_model(problem, m, options(m));
    count(run, state, found, {});
    at.best = std::max(at.best, log_mass(m));
  };
  const auto anneal_one = [&](int m) {
    ModelExploration& found = state.explorations[static_cast<std::size_t>(m)];
    if (!std::isfinite(problem.space[m].log_prior) || problem.space[m].dimension == 0 ||
        is_impossible(state, m))
      return;
    const bool negligible = problem.shortened && log_mass(m) < at.best - kNegligibleModel;
    if (negligible && found.settled()) {
      run.monitor.advance(1.0);
      return;
    }
    const ExplorationCalls before = found.calls;
    anneal_model(problem, m, options(m), negligible ? Annealing::brief : Annealing::as_needed,
                 found);
    count(run, state, found, before);
    at.best = std::max(at.best, log_mass(m));
  };
  if (at.explore == Position::Explore::search) {
    run.monitor.begin("searching", parts, later + (anneal ? kBriefAnnealing * parts : 0.0));
    run.monitor.advance(at.model);
    if (!each_left(survey) || !anneal) return;
    at.explore = Position::Explore::anneal;
    at.model = 0;
  }
  run.monitor.begin("annealing", parts, later);
  run.monitor.advance(at.model);
  each_left(anneal_one);
}

// Searches one of many models by climbs only. In a nested list (`lattice`), climbs start from the
// best mode of the models within m, from the mode of the most probable model one step from m, and
// from earlier modes of m.
void climb_only(RunContext& run, RunState& state, int m, const ModelLattice* lattice) {
  const Problem& problem = run.problem;
  const bool nested = lattice != nullptr;
  ModelExploration& found = state.explorations[static_cast<std::size_t>(m)];
  ExplorationOptions how{
      .seed = run.options.seed,
      .starts = nested_starts(problem.space, m, state.explorations, nested ? 1 : kNestedStarts),
      .climbs = run.options.searches > 0 ? run.options.searches : kClimbsInMany,
      .budget = kLeastBudget,
      .anneal = false,
      .climbs_only = true,
      .threads = run.options.threads,
      .stop = [&] { return run.monitor.stopped(); }};
  // Without starts in a nested list, m is the smallest model, from which other models get starts.
  if (nested && how.starts.empty() && run.options.searches == 0) how.climbs = 0;
  if (nested) {
    std::vector<double> around = start_from_around(problem.space, *lattice, m, state.explorations);
    if (!around.empty()) how.starts.push_back(std::move(around));
  }
  how.from_starts = nested && !how.starts.empty() && run.options.searches == 0;
  for (const Mode& mode : found.modes) how.starts.push_back(mode.z);
  found = explore_model(problem, m, how);
  count(run, state, found, {});
}

// ln π at the highest mode of each model. Evidences also depend on the accuracy of the integral.
std::vector<double> heights(const RunState& state) {
  std::vector<double> out;
  for (const ModelExploration& found : state.explorations) {
    out.push_back(-kInfinity);
    for (const Mode& mode : found.modes) out.back() = std::max(out.back(), mode.log_posterior);
  }
  return out;
}

// Searches the models in Occam's window by climbs until the window has no further models. Stores
// the models in at.models, so that a resumed run continues. Returns false if stopped.
bool climb_in_window(RunContext& run, RunState& state, const ModelLattice& lattice) {
  Position& at = state.at;
  for (;;) {
    for (; at.model < static_cast<int>(at.models.size()); ++at.model) {
      run.safe_points.pass(state);
      climb_only(run, state, at.models[static_cast<std::size_t>(at.model)], &lattice);
      if (!run.monitor.advance(1.0)) return false;
    }
    const std::vector<int> next = next_in_window(run.space(), lattice, state.explorations);
    if (next.empty()) return true;
    at.models.insert(at.models.end(), next.begin(), next.end());
  }
}

// Repeats the climbs in models that contain a model with a better mode than before.
void repeat_climbs(RunContext& run, RunState& state, const ModelLattice& lattice,
                   const std::vector<double>& before) {
  constexpr double kBetter = 3.0;  // ln
  const ModelSpace& space = run.space();
  const std::vector<double> now = heights(state);
  std::vector<int> better;
  for (int m = 0; m < space.size(); ++m) {
    const auto at = static_cast<std::size_t>(m);
    if (now[at] > before[at] + kBetter) better.push_back(m);
  }
  for (const int m : by_dimension(space)) {
    if (!state.explorations[static_cast<std::size_t>(m)].glanced ||
        std::ranges::none_of(better, [&](int b) { return is_within(space[b], space[m]); }))
      continue;
    climb_only(run, state, m, &lattice);
    if (run.monitor.stopped()) return;
  }
  for (;;) {
    const std::vector<int> next = next_in_window(space, lattice, state.explorations);
    if (next.empty()) return;
    for (const int m : next) {
      climb_only(run, state, m, &lattice);
      if (run.monitor.stopped()) return;
    }
  }
}

// Models searched by climbs only with a probability above `least`, the most probable first.
std::vector<int> probable(const RunContext& run, const RunState& state, double least) {
  const auto probability = [&](int m) { return state.probability[static_cast<std::size_t>(m)]; };
  std::vector<int> list = every_model(run);
  std::ranges::stable_sort(list, std::ranges::greater{}, probability);
  std::erase_if(list, [&](int m) {
    return probability(m) < least || !state.explorations[static_cast<std::size_t>(m)].glanced;
  });
  return list;
}

// Searches very many models by climbs: in order of size, or for a nested list, the models in
// Occam's window. Then searches the probable models fully.
void explore_many(RunContext& run, RunState& state) {
  using Part = Position::Explore;
  const Problem& problem = run.problem;
  std::optional<ModelLattice> lattice;
  if (problem.shortened && is_nested(problem.space)) lattice.emplace(problem.space);
  const bool nested = lattice.has_value();
  Position& at = state.at;
  if (at.explore == Part::begin) {
    at.explore = Part::climb;
    at.models = nested ? next_in_window(problem.space, *lattice, state.explorations)
                       : by_dimension(problem.space);
  }
  if (at.explore == Part::climb) {
    run.monitor.begin("searching", static_cast<double>(run.models()),
                      planned_searches(problem, run.options) + planned_tuning(run) +
                          planned_draws(run) + planned_evidence(run));
    run.monitor.advance(at.model);
    if (nested) {
      if (!climb_in_window(run, state, *lattice)) return;
    } else {
      for (; at.model < static_cast<int>(at.models.size()); ++at.model) {
        run.safe_points.pass(state);
        const int m = at.models[static_cast<std::size_t>(at.model)];
        if (!std::isfinite(problem.space[m].log_prior) || is_impossible(state, m)) continue;
        climb_only(run, state, m, nullptr);
        if (!run.monitor.advance(1.0)) return;
      }
    }
    estimate_probabilities(run, state);
    at.explore = Part::look;
    at.looks_left = kSearchedModels;
  }
  if (!nested) {
    if (at.explore == Part::look) {
      std::vector<int> list = probable(run, state, kReached);
      if (list.size() > kReachedModels) list.resize(kReachedModels);
      search_next(state, std::move(list));
    }
    return explore_each(run, state, false);
  }
  // Searches the probable models fully, in order of size, because their modes are starts for larger
  // models. After a full search, other models may become probable.
  for (; at.look < kSearchRounds; ++at.look) {
    if (at.explore == Part::look) {
      std::vector<int> list = probable(run, state, kLimits.searched_model);
      if (list.empty() || at.looks_left == 0) break;
      if (list.size() > static_cast<std::size_t>(at.looks_left))
        list.resize(static_cast<std::size_t>(at.looks_left));
      at.looks_left -= static_cast<int>(list.size());
      std::ranges::stable_sort(list, {}, [&](int m) { return problem.space[m].dimension; });
      at.before = heights(state);
      search_next(state, std::move(list));
    }
    explore_each(run, state, false, true);
    if (run.monitor.stopped()) return;
    repeat_climbs(run, state, *lattice, at.before);
    if (run.monitor.stopped()) return;
    estimate_probabilities(run, state);
    at.explore = Part::look;
  }
  for (ModelExploration& found : state.explorations) found.passed_over = !found.is_explored();
}

// Explores models for a long record, for which exploration from the prior is too expensive.
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
  if (!any)
    throw LikelihoodError(
        "the search on growing records found no posterior mode: check the priors and the noise");
  state.posterior.choices.push_back(Choice::started_on_first_samples);
}

// Starts the chains at draws of the populations, in different models if several are possible.
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

void end_exploring(RunContext& run, RunState& state) {
  count_exploring(state);
  if (run.monitor.stopped()) return;
  state.at.stage = Position::Stage::tune;
  run.safe_points.pass(state);
}

}  // namespace

void count_exploring(RunState& state) {
  state.posterior.calls.explore = state.posterior.warmup_evaluations =
      likelihood_evaluations(state);
}

void explore(RunContext& run, RunState& state) {
  const Problem& problem = run.problem;
  const bool list = problem.space.kinds().empty();
  const bool begins = state.at.explore == Position::Explore::begin;
  const bool balanced = problem.space.size() <= kBalancedModels;
  if (run.options.prior_only) {
    temper(run, state, {.scans = kExplorationScans});
    if (run.monitor.stopped()) return;
    pool_ladders(run, state);
    take_prior_probabilities(run, state);
    fit_proposals(run, state, 0);
    return end_exploring(run, state);
  }
  if (list && problem.samples >= kLongRecord && problem.shortened) {
    explore_growing(run, state);
  } else if (list && problem.space.size() <= kFewModels &&
             !(problem.shortened && problem.space.size() >= kManyNested &&
               is_nested(problem.space))) {
    if (begins) search_next(state, every_model(run));
    explore_each(run, state, !run.options.quick);
  } else if (list && problem.space.size() <= kManyModels) {
    explore_many(run, state);
  } else {
    if (begins) {
      temper(run, state, {.scans = kExplorationScans, .balanced = balanced});
      if (run.monitor.stopped()) return;
      pool_ladders(run, state);
      search_next(state, reached(run, state));
    }
    explore_each(run, state, false);
  }
  if (run.monitor.stopped()) return;
  estimate_probabilities(run, state);
  start_chains(run, state);
  fit_proposals(run, state, 0);
  end_exploring(run, state);
}

}  // namespace wheeltap::inference
