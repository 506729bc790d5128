#include "inference/engine/sample.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "inference/diagnosis/convergence.hpp"
#include "inference/engine/follow.hpp"
#include "inference/engine/temper.hpp"
#include "inference/engine/tune.hpp"
#include "inference/engine/weigh.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kSettling = 500;     // burn-in iterations
constexpr int kLadderScans = 620;  // number of scans if proposals were fitted before
constexpr int kMaxDraws = 200000;
// Share of a model's draws outside its mixture above which the mixture is fitted to the draws and
// the draws are repeated. The limit is lower than that of the diagnosis (which is used if an
// evaluation is expensive), because a run often converges after this fit.
constexpr double kWorthRefitting = 0.003;
constexpr int kMostRefits = 4;
constexpr int kScansTogether = 256;          // draws between two progress reports
constexpr std::size_t kAtHand = 1 << 16;     // draws between two calls of let_go
constexpr std::size_t kMaxPredictions = 64;  // longer predictions are not recorded

std::unique_ptr<KernelMixture> kernels_of(const RunContext& run, const RunState& state) {
  // If the draws have left the mixtures again after a refit, no mixture covers the posterior.
  const Reach reach = state.at.refits > 1 ? Reach::beyond : Reach::fitted;
  return sampling_kernels(run.problem, run.options, run.atlases, state.pilot, reach);
}

// Chooses the posterior modes whose shares of the draws are counted.
void choose_modes(RunState& state) {
  constexpr double kLeast = 1e-3;  // smallest share of a model's probability
  state.weighty_modes.assign(state.explorations.size(), {});
  for (std::size_t m = 0; m < state.explorations.size(); ++m) {
    const ModelExploration& found = state.explorations[m];
    CountedModes& of = state.weighty_modes[m];
    for (std::size_t k = 0; k < found.modes.size(); ++k) {
      if (k > 0 && found.shares[k] < kLeast) continue;
      of.modes.push_back(found.modes[k]);
      of.shares.push_back(found.shares[k]);
    }
    of.precisions = precisions_of(of.modes);
  }
}

// Runs a round of draws of one chain, with the fixed kernel at β = 1 or on the chain's ladder.
class Sampler {
 public:
  Sampler(const RunContext& run, const RunState& state, int c, ChainState& chain, Target& target)
      : run_(run), state_(state), c_(c), chain_(chain), target_(target) {
    if (state.posterior.tempered_draws) {
      tempered_ = std::make_unique<TemperedChain>(
          target, *chain.ladder, [&] { return kernels_of(run, state); }, run.options.seed, c);
    } else {
      kernels_ = kernels_of(run, state);
    }
  }
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  ~Sampler() {
    if (tempered_) chain_.ladder = tempered_->ladder();
  }

  // Makes the burn-in iterations; a stop of the run skips the remaining iterations.
  void settle(int iterations) {
    for (int i = 0; i < iterations && !run_.monitor.stopped(); ++i) {
      if (tempered_) {
        if (i % kStepsAScan == 0) tempered_->scan(1, false, base::Purpose::settling);
        continue;
      }
      base::Random random(run_.options.seed, static_cast<std::uint64_t>(c_),
                          static_cast<std::uint64_t>(i), base::Purpose::settling);
      Kernel::Outcome outcome;
      kernels_->step(chain_.state, {target_, random, 1.0, false}, outcome);
    }
  }

  // Makes `thin` iterations and records the resulting draw.
  void draw(Chain& out) {
    int move = -1;
    bool accepted = false;
    const auto observe = [&](int kernel, const Kernel::Outcome& outcome, int from_model) {
      move = kernel;
      accepted = outcome.accepted;
      if (!outcome.proposed) return;  // hence kernel >= 0
      MoveStatistics& statistics = chain_.moves[static_cast<std::size_t>(kernel)];
      ++statistics.proposed;
      statistics.accepted += outcome.accepted ? 1 : 0;
      const auto from = static_cast<std::size_t>(from_model);
      const auto to = static_cast<std::size_t>(outcome.to_model);
      ++chain_.proposed[from][to];
      chain_.accepted[from][to] += outcome.accepted ? 1 : 0;
    };
    if (tempered_) {
      tempered_->scan(state_.posterior.thin, false, base::Purpose::sampling, observe);
      chain_.state = tempered_->cold();
    }
    for (int t = 0; !tempered_ && t < state_.posterior.thin; ++t) {
      base::Random random(run_.options.seed, static_cast<std::uint64_t>(c_),
                          static_cast<std::uint64_t>(chain_.iteration++), base::Purpose::sampling);
      Kernel::Outcome outcome;
      const int from = chain_.state.model;
      const int kernel = kernels_->step(chain_.state, {target_, random, 1.0, false}, outcome);
      observe(kernel, outcome, from);
    }
    record(run_, state_, target_, move, accepted, chain_, out);
  }

 private:
  const RunContext& run_;
  const RunState& state_;
  int c_;
  ChainState& chain_;
  Target& target_;
  std::unique_ptr<KernelMixture> kernels_;
  std::unique_ptr<TemperedChain> tempered_;
};

// Collects the counters of all chains.
void collect(RunState& state) {
  Posterior& posterior = state.posterior;
  posterior.moves.clear();
  posterior.ladder_round_trips = 0;
  for (const ChainState& chain : state.chains) {
    if (posterior.tempered_draws) posterior.ladder_round_trips += chain.ladder->round_trips;
    if (posterior.moves.empty()) {
      posterior.moves = chain.moves;
      posterior.jumps_proposed = chain.proposed;
      posterior.jumps_accepted = chain.accepted;
      continue;
    }
    for (std::size_t i = 0; i < chain.moves.size(); ++i) {
      posterior.moves[i].proposed += chain.moves[i].proposed;
      posterior.moves[i].accepted += chain.moves[i].accepted;
    }
    for (std::size_t a = 0; a < chain.proposed.size(); ++a) {
      for (std::size_t b = 0; b < chain.proposed.size(); ++b) {
        posterior.jumps_proposed[a][b] += chain.proposed[a][b];
        posterior.jumps_accepted[a][b] += chain.accepted[a][b];
      }
    }
  }
  const Chain& any = posterior.chains.front();
  posterior.predictions =
      any.model.empty() ? 0 : static_cast<int>(any.prediction.size() / any.size());
}

// Reserves memory for draws of the same size as `at`.
void reserve(Chain& chain, int goal, std::size_t dimension, const State& at) {
  constexpr int kMost = 4'000'000;  // limit, because a run may not reach a larger goal
  const std::size_t predictions = at.prediction.size();
  chain.reserve(static_cast<std::size_t>(std::min(goal, kMost)), dimension,
                predictions <= kMaxPredictions ? predictions : 0);
}

// Draws until the goal is reached.
void draw_on(RunContext& run, RunState& state) {
  const int goal = state.at.goal;
  run.complete_each_chain(state, [&](int c, ChainState& chain, Target& target) {
    Sampler sampler(run, state, c, chain, target);
    Chain& out = state.posterior.chains[static_cast<std::size_t>(c)];
    reserve(out, goal, static_cast<std::size_t>(state.posterior.dimension), chain.state);
    std::vector<long> visits(run.models(), 0);
    long before = target.evaluations();
    while (static_cast<int>(out.size()) < goal) {
      sampler.draw(out);
      ++visits[static_cast<std::size_t>(chain.state.model)];
      if (out.size() % kScansTogether == 0) {
        run.monitor.evaluated(target.evaluations() - before);
        before = target.evaluations();
        run.monitor.visited(visits);
        std::fill(visits.begin(), visits.end(), 0);
        run.monitor.advance(static_cast<double>(kScansTogether));
      }
      if (out.size() % kAtHand == 0) out.let_go();
      if (run.leave()) break;
    }
    return static_cast<int>(out.size()) == goal;
  });
  // After an early stop, truncates all chains to the length of the shortest chain.
  std::vector<Chain>& chains = state.posterior.chains;
  std::size_t common = chains.front().size();
  for (const Chain& chain : chains) common = std::min(common, chain.size());
  for (Chain& chain : chains) {
    chain.truncate(common);
    chain.settle();
  }
  state.posterior.draws = static_cast<int>(common);
  collect(state);
}

void draw_and_weigh(RunContext& run, RunState& state) {
  const Posterior& posterior = state.posterior;
  run.monitor.begin(posterior.draws > 0   ? "more sampling"
                    : state.at.refits > 0 ? "sampling again"
                    : posterior.tempered_draws && !run.options.tempered_draws
                        ? "sampling with tempering"
                        : "sampling",
                    static_cast<double>(state.at.goal - posterior.draws) * run.options.chains,
                    planned_evidence(run));
  for (const Chain& chain : posterior.chains)
    run.monitor.advance(static_cast<double>(chain.size()) - posterior.draws);
  draw_on(run, state);
  if (!run.monitor.stopped()) run.safe_points.pass(state);
  weigh(run, state);
}

void set_up_ladder(RunContext& run, RunState& state) {
  temper(
      run, state,
      {.scans = kLadderScans, .balanced = run.space().size() <= kBalancedModels, .fitted = true});
  run.each_chain_here(
      state, [&](ChainState&, Target& target) { target.set_model_bias(state.sampling_bias); });
}

// Turns all draws so far into warm-up.
void forget_draws(RunState& state) {
  Posterior& posterior = state.posterior;
  posterior.warmup += posterior.draws * posterior.thin;
  posterior.draws = 0;
  for (Chain& chain : posterior.chains) chain.clear();
  state.at.first_part += static_cast<long>(state.at.part_chains.size());
  state.at.part_chains.clear();
}

// Counts all likelihood evaluations so far as evaluations of the tuning.
void count_as_tuning(RunState& state) {
  Calls& calls = state.posterior.calls;
  state.posterior.warmup_evaluations = likelihood_evaluations(state);
  calls.tune = state.posterior.warmup_evaluations - calls.explore - calls.evidence;
}

// The largest share of draws outside the mixture, over the models above the probability limit.
double share_outside_mixtures(const Posterior& posterior) {
  double most = 0.0;
  for (std::size_t m = 0; m < posterior.found.size(); ++m) {
    const double share = posterior.found[m].beyond_mixture;
    if (share > most && posterior.probability(static_cast<int>(m)).value >= kLimits.worth_knowing)
      most = share;
  }
  return most;
}

// Fits the mixtures to the draws so far and to the states of chains started at SMC draws. The draws
// so far become warm-up.
void refit_to_draws(RunContext& run, RunState& state, const std::vector<Eigen::MatrixXd>& met) {
  for (ChainState& chain : state.chains) {
    chain.by_rung.assign(1, PilotSamples(run.space()));
    PilotSamples& samples = chain.by_rung.front();
    State at;
    for (int m = 0; m < run.space().size(); ++m) {
      const KeptDraws::OfModel& kept = chain.kept->of(m);
      at.model = m;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        at.z.assign(kept.row(i).begin(), kept.row(i).end());
        samples.add(at);
      }
    }
  }
  PilotSamples& samples = state.chains.front().by_rung.front();
  State at;
  for (int m = 0; m < run.space().size(); ++m) {
    at.model = m;
    for (const auto column : met[static_cast<std::size_t>(m)].colwise()) {
      at.z.assign(column.begin(), column.end());
      samples.add(at);
    }
  }
  ++state.at.refits;
  fit_proposals(run, state, ++state.at.round);
  state.at_mixture.assign(run.models(), {});
  forget_draws(state);
  count_as_tuning(state);
  state.at.sample = Position::Sample::prepare;
  state.at.goal = first_draws(run.problem, run.options);
}

// Restarts with a tempering ladder after the chains disagreed, because they visited different
// modes. The draws so far become warm-up.
void restart_tempered(const RunContext& run, RunState& state) {
  Posterior& posterior = state.posterior;
  posterior.tempered_draws = true;
  posterior.choices.push_back(Choice::restarted_tempered);
  forget_draws(state);
  if (run.options.thin == 0) posterior.thin = 1;  // a scan makes several steps at each rung
  state.at.sample = Position::Sample::ladder;
  state.at.goal = first_draws(run.problem, run.options);
}

}  // namespace

void prepare_draws(RunContext& run, RunState& state) {
  choose_modes(state);
  const auto kernels = kernels_of(run, state);
  for (ChainState& chain : state.chains) {
    chain.kept.emplace(run.space());
    chain.at_mode.clear();
    for (const CountedModes& of : state.weighty_modes) chain.at_mode.emplace_back(of.modes.size());
    if (state.posterior.tempered_draws) {
      chain.ladder->weights.back() = state.sampling_bias;
      chain.ladder->states.back() = chain.state;
      chain.ladder->reset_round_trips();
    }
    chain.moves.clear();
    for (int i = 0; i < kernels->size(); ++i) chain.moves.push_back({.name = (*kernels)[i].name()});
    chain.proposed.assign(run.models(), std::vector<long>(run.models()));
    chain.accepted = chain.proposed;
  }
}

void record(const RunContext& run, const RunState& state, const Target& target, int move,
            bool accepted, ChainState& chain, Chain& out) {
  const State& at = chain.state;
  out.model.push_back(at.model);
  out.theta.append(at.x.begin(), at.x.end());
  out.theta.resize(out.size() * static_cast<std::size_t>(state.posterior.dimension),
                   std::numeric_limits<double>::quiet_NaN());
  out.log_prior.push_back(target.log_prior_physical(at));
  out.log_likelihood.push_back(at.log_likelihood);
  out.move.push_back(static_cast<std::int16_t>(move));
  out.accepted.push_back(accepted ? 1 : 0);
  const auto m = static_cast<std::size_t>(at.model);
  const CountedModes& of = state.weighty_modes[m];
  if (const int k = nearest_mode(of.modes, of.precisions, at.z); k >= 0) {
    ++chain.at_mode[m][static_cast<std::size_t>(k)];
  }
  chain.kept->add(at, target.log_prior(at) + at.log_likelihood - run.space()[at.model].log_prior -
                          state.sampling_bias[m]);
  if (at.prediction.size() <= kMaxPredictions) {
    for (const double value : at.prediction) out.prediction.push_back(static_cast<float>(value));
  }
}

void settle(RunContext& run, RunState& state) {
  const int iterations =
      run.options.warmup > 0 ? std::min(kSettling, run.options.warmup) : kSettling;
  run.each_chain(state, [&](int c, ChainState& chain, Target& target) {
    Sampler(run, state, c, chain, target).settle(iterations);
  });
  state.posterior.warmup += iterations;
}

void draw(RunContext& run, RunState& state, int n) {
  state.at.goal = state.posterior.draws + n;
  draw_on(run, state);
}

void sample(RunContext& run, RunState& state) {
  using Part = Position::Sample;
  const Options& options = run.options;
  Posterior& posterior = state.posterior;
  Part& part = state.at.sample;
  if (part == Part::begin) {
    posterior.tempered_draws = options.tempered_draws;
    state.at.goal = first_draws(run.problem, options);
    const bool ladder = posterior.tempered_draws && !state.chains.front().ladder;
    part = ladder ? Part::ladder : Part::prepare;
  }
  while (true) {
    if (part == Part::ladder) {
      set_up_ladder(run, state);
      if (run.monitor.stopped()) return;
      count_as_tuning(state);
      part = Part::prepare;
    }
    if (part == Part::prepare) {
      prepare_draws(run, state);
      part = Part::settle;
      run.safe_points.pass(state);
    }
    if (part == Part::settle) {
      settle(run, state);
      if (run.monitor.stopped()) return;
      part = Part::draw;
      run.safe_points.pass(state);
    }
    draw_and_weigh(run, state);
    const std::vector<Eigen::MatrixXd> met = follow_annealed(run, state);
    if (options.draws > 0 || run.monitor.stopped() || posterior.draws >= kMaxDraws) return;
    const bool enough = may_stop(posterior, options.balance);
    if (options.moves.independence && !posterior.tempered_draws && !options.prior_only &&
        state.at.refits < (enough ? 1 : kMostRefits) &&
        (share_outside_mixtures(posterior) >
             (run.problem.costly ? kLimits.beyond_share : kWorthRefitting) ||
         std::ranges::any_of(posterior.found, [](const ModelFindings& found) {
           return lacks_annealed(found, kWorthFollowing);
         }))) {
      refit_to_draws(run, state, met);
      continue;
    }
    if (enough) return;
    if (!posterior.tempered_draws && options.moves.tempering && !options.prior_only &&
        !chains_agree(posterior)) {
      restart_tempered(run, state);
    } else {
      state.at.goal += std::min(posterior.draws, kMaxDraws - posterior.draws);
    }
  }
}

}  // namespace wheeltap::inference
