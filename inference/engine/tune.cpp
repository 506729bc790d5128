#include "inference/engine/tune.hpp"

#include <algorithm>
#include <array>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/engine/model_probabilities.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kBetweenLooks = 4;                          // steps between two clock readings
constexpr std::array<int, 3> kTuning{4000, 8000, 20000};  // steps before each fit
static_assert(kTuning[0] + kTuning[1] + kTuning[2] == kTuningSteps);
// Length of an additional last round if the model index has fewer effective draws than
// kEnoughModelDraws. A run needs about 15 000 effective draws to know a probability of ½ to 0.004.
// Mixtures fitted to few samples give effective draws slowly.
constexpr int kLongTuning = 80000;
constexpr double kEnoughModelDraws = 4000.0;
// Number of draws of a model's population (ModelExploration) in the first fit.
constexpr Eigen::Index kFirstPopulation = 1000;
constexpr Eigen::Index kLastPopulation = 4000;  // the same for the last fit
constexpr int kManyPeaks = 80;                  // mixture components for posteriors with many modes
// For a long record: number of components before the last fit, and tolerance of the fits. With the
// values for other problems, the fits took a quarter of the run time.
constexpr int kFewPeaks = 7;
constexpr double kRoughly = 1e-5;
// With a costly likelihood and a single model, tuning ends when the current proposals give this
// number of effective draws in fewer steps than the next round of tuning. Tuning also ends when
// the share kGoodRenewal of the draws of the mixture is accepted, because more rounds then hardly
// improve it. With a share below kFairRenewal, the mixture does not cover the posterior, and later
// refits cost more than tuning.
// Tuning has at least this number of steps per chain and dimension.
constexpr double kEnoughDraws = 1000.0;
constexpr double kGoodRenewal = 0.3, kFairRenewal = 0.15;
constexpr int kStepsADimension = 100;
// In tuning, less probable models get fewer visits than the others, because no draws of these
// models are expected.
constexpr double kLeastTuned = 1e-4;
constexpr double kNoLeast = 1e-12;  // the same limit for balanced draws

Eigen::MatrixXd thinned(const Eigen::MatrixXd& columns, Eigen::Index most) {
  if (columns.cols() <= most) return columns;
  Eigen::MatrixXd out(columns.rows(), most);
  for (Eigen::Index i = 0; i < most; ++i) out.col(i) = columns.col(i * columns.cols() / most);
  return out;
}

// Efficiency of each kernel in the last round of tuning, over all chains.
std::vector<double> efficiencies(const RunContext& run, const RunState& state) {
  std::vector<KernelRecord> sums(state.chains.front().records.size());
  for (const ChainState& chain : state.chains)
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += chain.records[k];
  return kernel_efficiencies(
      *sampling_kernels(run.problem, run.options, run.atlases, state.pilot, Reach::tuning), sums);
}

// Effective draws of a single model's parameters in the last round of tuning, the fewest of all
// parameters.
double tuned_draws(const RunState& state) {
  std::vector<Eigen::MatrixXd> chains;
  for (const ChainState& chain : state.chains) chains.push_back(chain.by_rung.at(0).states(0));
  double least = kInfinity;
  for (Eigen::Index j = 0; j < chains.front().rows(); ++j) {
    ChainsOf values;
    for (const Eigen::MatrixXd& states : chains)
      values.emplace_back(states.row(j).begin(), states.row(j).end());
    least = std::min(least, ess_mean(values));
  }
  return least;
}

// The share of accepted draws of the mixture in the last round of tuning.
double accepted_renewals(const RunContext& run, const RunState& state) {
  const auto kernels =
      sampling_kernels(run.problem, run.options, run.atlases, state.pilot, Reach::tuning);
  KernelRecord sum;
  for (int k = 0; k < kernels->size(); ++k)
    if ((*kernels)[k].name() == "mixture renewal")
      for (const ChainState& chain : state.chains)
        sum += chain.records[static_cast<std::size_t>(k)];
  return static_cast<double>(sum.accepted) / std::max(1.0, static_cast<double>(sum.proposed));
}

// True if a costly likelihood needs no further round of tuning. False if the user states the number
// of warm-up iterations or of draws.
bool is_tuned(const RunContext& run, const RunState& state) {
  const bool is_given = run.options.warmup > 0 || run.options.draws > 0;
  const auto next = static_cast<std::size_t>(state.at.round) + 1;
  if (is_given || !run.problem.costly || run.models() != 1 || !run.problem.space.kinds().empty() ||
      next >= kTuning.size() || state.at.tuned < kStepsADimension * run.space()[0].dimension)
    return false;
  const double renewals = accepted_renewals(run, state);
  if (renewals > kGoodRenewal) return true;
  if (renewals < kFairRenewal) return false;
  // Lengths of the rounds of tuning are in proportion to kTuning. Both sides are numbers of steps,
  // in units of the last round.
  return kEnoughDraws / tuned_draws(state) <
         static_cast<double>(kTuning[next]) / static_cast<double>(kTuning[next - 1]);
}

// Runs a round of `steps` steps, or the rest of the round, and fits the proposals.
void tune_once(RunContext& run, RunState& state, int steps) {
  state.tuning_bias = equal_visits_bias(state.probability, kLeastTuned);
  run.complete_each_chain(state, [&](int c, ChainState& chain, Target& target) {
    int& i = chain.adaptation.steps;
    if (i > 0 && i == steps) return true;
    target.set_model_bias(state.tuning_bias);
    const auto kernels =
        sampling_kernels(run.problem, run.options, run.atlases, state.pilot, Reach::tuning);
    if (i == 0) {
      chain.by_rung.assign(1, PilotSamples(run.space()));
      chain.models.clear();
      chain.records.assign(static_cast<std::size_t>(kernels->size()), {});
    } else {
      kernels->restore(chain.adaptation.learnt.at(0));
    }
    long before = target.evaluations();
    while (i < steps) {
      base::Random random(run.options.seed, static_cast<std::uint64_t>(c),
                          static_cast<std::uint64_t>(state.at.tuned + i),
                          base::Purpose::adaptation);
      Kernel::Outcome outcome;
      const int from = chain.state.model;
      const int kernel = kernels->step(chain.state, {target, random, 1.0, true}, outcome);
      if (kernel >= 0)
        chain.records[static_cast<std::size_t>(kernel)].add(outcome, outcome.to_model != from);
      chain.by_rung[0].add(chain.state);
      chain.models.push_back(chain.state.model);
      ++i;
      if (i % 64 == 0) {
        run.monitor.evaluated(target.evaluations() - before);
        before = target.evaluations();
        run.monitor.advance(64.0);
      }
      if (i % kBetweenLooks == 0 && run.leave()) break;
    }
    chain.adaptation.learnt.assign(1, kernels->learnt());
    return i == steps;
  });
  if (run.monitor.stopped()) return;
  state.at.tuned += steps;
  state.at.round = is_tuned(run, state)
                       ? std::max(state.at.round + 1, static_cast<int>(kTuning.size()))
                       : state.at.round + 1;
  fit_proposals(run, state, state.at.round);
  for (ChainState& chain : state.chains) chain.adaptation = {};
  run.safe_points.pass(state);
}

// The fewest effective draws of a model's indicator in the last round of tuning; infinite if one
// model has all the probability. Unless the draws will visit models as evenly as tuning (`evenly`),
// models that are nearly certain or negligible do not count.
double tuned_model_draws(const RunState& state, bool evenly) {
  constexpr double kMatters = 1e-3;
  double least = kInfinity;
  for (std::size_t m = 0; m < state.pilot.fit->weight.size(); ++m) {
    const double p = state.pilot.fit->weight[m], drawn = state.probability[m];
    if (p < 0.02 || p > 0.98) continue;
    if (!evenly && std::min(drawn, 1.0 - drawn) < kMatters) continue;
    ChainsOf indicator;
    for (const ChainState& chain : state.chains) {
      std::vector<double>& values = indicator.emplace_back();
      for (const int model : chain.models)
        values.push_back(model == static_cast<int>(m) ? 1.0 : 0.0);
    }
    least = std::min(least, ess_mean(indicator));
  }
  return least;
}

}  // namespace

void fit_proposals(RunContext& run, RunState& state, int round) {
  std::vector<PilotSamples> pooled = state.by_rung;
  if (round > 0 || pooled.empty()) {
    pooled.emplace_back(run.space());
    if (round > 0)
      for (const ChainState& chain : state.chains) pooled.back().append(chain.by_rung.back());
  }
  // A refit uses thinned draws, whose numbers are not those of visits.
  if (round > 0 && state.at.refits == 0) learn_probabilities(state, pooled.back());
  // The draws use only the last fit; the earlier fits prepare it.
  const bool last = round >= static_cast<int>(kTuning.size());
  const bool dear = is_expensive(run.problem, run.options);
  PilotOptions how{.seed = run.options.seed,
                   .round = round,
                   .threads = run.options.threads,
                   .most_samples = last ? 12000 : 3000,
                   .most_components = dear && !last ? kFewPeaks : 20,
                   .besides = {},
                   .probability = state.probability,
                   .modes = {}};
  for (const ModelExploration& found : state.explorations) {
    Eigen::Index most = last ? kLastPopulation : kFirstPopulation;
    if (run.options.warmup > 0)
      most = std::min<Eigen::Index>(most, std::max(run.options.warmup, 400));
    how.besides.push_back(thinned(found.population, most));
    how.modes.emplace_back();
    for (std::size_t k = 0; k < found.modes.size() && k < 40; ++k) {
      const Mode& mode = found.modes[k];
      how.modes.back().push_back({std::max(found.shares[k], 1e-3),
                                  Eigen::Map<const Eigen::VectorXd>(
                                      mode.z.data(), static_cast<Eigen::Index>(mode.z.size())),
                                  Eigen::LLT<Eigen::MatrixXd>(mode.covariance).matrixL()});
    }
    const auto weighty =
        std::ranges::count_if(found.shares, [](double share) { return share > 0.005; });
    if (last && (weighty > 10 || state.at.refits > 0)) how.most_components = kManyPeaks;
  }
  if (dear) how.tolerance = kRoughly;
  std::vector<double> learnt;
  if (round > 0) learnt = efficiencies(run, state);
  state.pilot = fit_pilot(run.space(), pooled, how);
  state.pilot.efficiencies = std::move(learnt);
}

void tune(RunContext& run, RunState& state) {
  const Options& options = run.options;
  Position& at = state.at;
  constexpr int kRounds = static_cast<int>(kTuning.size());
  const double later = planned_draws(run) + planned_evidence(run);
  const auto begin_monitor = [&](const char* stage, int steps) {
    run.monitor.begin(stage, static_cast<double>(steps) * options.chains, later);
    for (const ChainState& chain : state.chains)
      run.monitor.advance(static_cast<double>(chain.adaptation.steps));
  };
  if (at.round < kRounds) {
    begin_monitor("tuning",
                  options.warmup > 0 ? options.warmup / 2 : tuning_steps(run.problem, run.options));
    run.monitor.advance(static_cast<double>(at.tuned) * options.chains);
  }
  while (at.round < kRounds && !run.monitor.stopped()) {
    const double share =
        static_cast<double>(kTuning[static_cast<std::size_t>(at.round)]) / kTuningSteps;
    const double all =
        options.warmup > 0 ? 0.5 * options.warmup : tuning_steps(run.problem, run.options);
    tune_once(run, state, static_cast<int>(all * share));
  }
  if (at.round == kRounds && !run.monitor.stopped() && options.warmup == 0) {
    const int thin = state.posterior.thin;
    const int longest =
        options.draws > 0 ? std::min(kLongTuning / thin, options.draws) * thin : kLongTuning;
    const bool begun = std::ranges::any_of(
        state.chains, [](const ChainState& chain) { return chain.adaptation.steps > 0; });
    if (begun || (longest > kTuning.back() &&
                  tuned_model_draws(state, options.balance) < kEnoughModelDraws)) {
      begin_monitor("tuning on", longest);
      tune_once(run, state, longest);
    }
  }
  // Model weights of the draws: 0, or weights with which the chains visit all models equally often.
  state.sampling_bias = options.balance ? equal_visits_bias(state.probability, kNoLeast)
                                        : std::vector<double>(run.models(), 0.0);
  if (options.balance) {
    for (const double b : state.sampling_bias) state.posterior.log_weight.push_back(-b);
  }
  run.each_chain_here(
      state, [&](ChainState&, Target& target) { target.set_model_bias(state.sampling_bias); });
  state.posterior.warmup += at.tuned;
  const long explored = state.posterior.warmup_evaluations;
  state.posterior.warmup_evaluations = likelihood_evaluations(state);
  state.posterior.calls.tune += state.posterior.warmup_evaluations - explored;
  if (run.monitor.stopped()) return;
  at.stage = Position::Stage::sample;
  run.safe_points.pass(state);
}

}  // namespace wheeltap::inference
