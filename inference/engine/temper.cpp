#include "inference/engine/temper.hpp"
#include "inference/engine/run_plan.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace wheeltap::inference {
namespace {

constexpr int kExplorationRungs = 10;
constexpr int kStageMaxRungs = 30;
constexpr int kFewestScans = 620;
constexpr int kStageFirstScans = 20;
// A longer scan may be interrupted. A resumed run repeats the scan from the state before it.
constexpr std::chrono::milliseconds kLongScan{100};

// All data that a scan changes.
struct BeforeScan {
  Ladder ladder;
  std::vector<std::vector<double>> learnt;
  Target::Memory target;
};

}  // namespace

void temper(RunContext& run, RunState& state, const TemperOptions& how) {
  const Options& options = run.options;
  const bool chosen = options.warmup == 0 && !how.fitted;  // the engine chooses the length
  const int scans = options.warmup > 0
                        ? std::max(60, options.warmup / (2 * kExplorationRungs * kStepsAScan))
                        : how.scans;
  const double later = planned_draws(run) + planned_evidence(run) +
                       (how.fitted || options.prior_only
                            ? 0.0
                            : planned_searches(run.problem, options) + planned_tuning(run));
  run.monitor.begin(how.fitted ? "setting up the ladder" : "exploring",
                    static_cast<double>(scans) * options.chains, later);
  for (const ChainState& chain : state.chains)
    if (state.at.tempering) run.monitor.advance(chain.adaptation.scans + chain.adaptation.steps);
  if (!state.at.tempering) {
    for (ChainState& chain : state.chains) chain.adaptation = {};
    state.at.tempering = true;
  }
  run.complete_each_chain(state, [&](int c, ChainState& chain, Target& target) {
    AdaptationState& at = chain.adaptation;
    if (at.ended) return true;
    const int rungs = options.moves.tempering ? kExplorationRungs : 1;
    TemperedChain tempered(
        target,
        at.begun ? *chain.ladder
                 : Ladder(rungs > 1 ? geometric_ladder(rungs) : std::vector<double>{1.0},
                          run.space().size()),
        [&] {
          return how.fitted ? sampling_kernels(run.problem, options, run.atlases, state.pilot,
                                               Reach::fitted)
                            : exploration_kernels(run.problem, options, run.atlases);
        },
        options.seed, c);
    if (at.begun) {
      tempered.restore(at.learnt);
    } else {
      tempered.start();
      if (how.fitted) tempered.set_cold(chain.state);
      if (how.balanced) tempered.balance_models();
      at.begun = true;
      at.round_scans = kStageFirstScans;
    }
    std::optional<BeforeScan> before_scan;  // for long scans
    bool left = false;                      // interrupted within a scan
    while (!at.ended && !run.monitor.stopped()) {
      // Only the last round is used: it takes a remainder that is shorter than a further round.
      const int left_scans = scans - at.scans;
      const int n = left_scans < 3 * at.round_scans ? left_scans : at.round_scans;
      if (at.steps == 0)
        chain.by_rung.assign(static_cast<std::size_t>(tempered.rungs()), PilotSamples(run.space()));
      while (at.steps < n) {
        using Clock = std::chrono::steady_clock;
        const long before = target.evaluations();
        const auto began = Clock::now();
        if (before_scan) before_scan = {tempered.ladder(), tempered.learnt(), target.memory()};
        const auto leave = [&] { return before_scan && run.monitor.stopped(); };
        if (!tempered.scan(kStepsAScan, true, base::Purpose::exploration, nullptr, leave)) {
          left = true;
          break;
        }
        if (!before_scan && Clock::now() - began > kLongScan)
          before_scan = {tempered.ladder(), tempered.learnt(), target.memory()};
        for (int r = 0; r < tempered.rungs(); ++r) {
          chain.by_rung[static_cast<std::size_t>(r)].add(tempered.state(r));
        }
        ++at.steps;
        run.monitor.evaluated(target.evaluations() - before);
        run.monitor.advance(1.0);
        if (run.leave()) break;
      }
      if (at.steps < n) break;
      at.scans += n;
      at.steps = 0;
      at.round_scans *= 2;
      at.barrier = tempered.barrier();
      // A round trip takes about 2 + 2 Λ scans (Syed et al. 2022, section 3.5); 100 trips
      // suffice.
      at.ended = at.scans >= scans || (chosen && at.scans >= kFewestScans &&
                                       at.scans >= 100.0 * (2.0 + 2.0 * at.barrier));
      // Two rungs per unit of the barrier Λ (Syed et al. 2022, section 4.3), while scans remain.
      if (tempered.rungs() > 1 && !at.ended) {
        tempered.adapt_ladder(
            std::clamp(static_cast<int>(std::ceil(2.0 * at.barrier)) + 2, 6, kStageMaxRungs));
      }
    }
    if (left) {
      chain.ladder = std::move(before_scan->ladder);
      at.learnt = std::move(before_scan->learnt);
      target.set_memory(before_scan->target);
      return false;
    }
    chain.ladder = tempered.ladder();
    at.learnt = at.ended ? std::vector<std::vector<double>>{} : tempered.learnt();
    if (!at.ended) return false;
    chain.state = tempered.cold();
    target.set_model_bias(std::vector<double>(run.models(), 0.0));
    return true;
  });
  state.posterior.warmup += state.chains.front().adaptation.scans * kStepsAScan;
  double& barrier = state.posterior.barrier = 0.0;
  for (const ChainState& chain : state.chains)
    barrier = std::max(barrier, chain.adaptation.barrier);
  if (run.monitor.stopped()) return;
  state.at.tempering = false;
  for (ChainState& chain : state.chains) chain.adaptation = {};
}

void pool_ladders(const RunContext& run, RunState& state) {
  std::size_t rungs = 0;
  for (const ChainState& chain : state.chains) rungs = std::max(rungs, chain.by_rung.size());
  state.by_rung.assign(rungs, PilotSamples(run.space()));
  for (const ChainState& chain : state.chains) {
    for (std::size_t r = 0; r < chain.by_rung.size(); ++r) {
      state.by_rung[rungs - 1 - r].append(chain.by_rung[chain.by_rung.size() - 1 - r]);
    }
  }
}

}  // namespace wheeltap::inference
