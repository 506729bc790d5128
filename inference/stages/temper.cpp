#include "inference/stages/temper.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::inference {
namespace {

constexpr int kExplorationRungs = 10;
constexpr int kMaxRungs = 30;
constexpr int kFewestScans = 620;
constexpr int kFirstScans = 20;

}  // namespace

void temper(RunContext& run, RunState& state, const TemperOptions& how) {
  const Options& options = run.options;
  const bool chosen = options.warmup == 0 && !how.fitted;  // how long, by the engine
  const int scans = options.warmup > 0
                        ? std::max(60, options.warmup / (2 * kExplorationRungs * kStepsAScan))
                        : how.scans;
  run.monitor.begin(how.fitted ? "setting up the ladder" : "exploring",
                    static_cast<double>(scans) * options.chains);
  std::vector<double> barriers(state.chains.size(), 0.0);
  run.each_chain(state, [&](int c, ChainState& chain, Target& target) {
    const int rungs = options.moves.tempering ? kExplorationRungs : 1;
    TemperedChain tempered(
        target, rungs > 1 ? geometric_ladder(rungs) : std::vector<double>{1.0},
        [&] {
          return how.fitted ? sampling_kernels(run.problem, options, run.atlases, state.pilot)
                            : exploration_kernels(run.problem, options, run.atlases);
        },
        options.seed, c);
    tempered.start();
    if (how.fitted) tempered.set_cold(chain.state);
    if (how.balanced) tempered.balance_models();
    int done = 0;
    bool stopped = false;
    for (int round = kFirstScans; done < scans && !stopped; round *= 2) {
      const int n = std::min(round, scans - done);
      chain.by_rung.assign(static_cast<std::size_t>(tempered.rungs()), PilotSamples(run.space()));
      for (int i = 0; i < n && !stopped; ++i) {
        const long before = target.evaluations();
        tempered.scan(kStepsAScan, true, base::Purpose::exploration);
        for (int r = 0; r < tempered.rungs(); ++r) {
          chain.by_rung[static_cast<std::size_t>(r)].add(tempered.state(r));
        }
        run.monitor.evaluated(target.evaluations() - before);
        stopped = !run.monitor.advance(1.0);
      }
      if (stopped) break;
      done += n;
      if (c == 0) state.posterior.warmup += n * kStepsAScan;
      const double barrier = barriers[static_cast<std::size_t>(c)] = tempered.barrier();
      // A round trip takes some 2 + 2 Λ scans (Syed et al. 2022, section 3.5): a hundred of them
      // will do.
      if (chosen && done >= kFewestScans && done >= 100.0 * (2.0 + 2.0 * barrier)) break;
      // Two neighbours a unit of the barrier (ibid., section 4.3), while there is time left.
      if (tempered.rungs() > 1 && done < scans) {
        tempered.adapt_ladder(
            std::clamp(static_cast<int>(std::ceil(2.0 * tempered.barrier())) + 2, 6, kMaxRungs));
      }
    }
    chain.ladder = tempered.ladder();
    if (stopped) return;
    chain.state = tempered.cold();
    target.set_model_bias(std::vector<double>(run.models(), 0.0));
  });
  state.posterior.barrier = *std::ranges::max_element(barriers);
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
