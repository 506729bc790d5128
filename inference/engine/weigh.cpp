#include "inference/engine/weigh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/constants.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "inference/evidence/bridge_sampling.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kWorthWeighing = 1e-4;  // smallest probability of a model searched by climbs only

Evidence by_importance(const std::vector<double>& log_ratios) {
  Evidence evidence = kNoEvidence;
  const double top = *std::ranges::max_element(log_ratios);
  if (top == -kInfinity) return evidence;
  double sum = 0.0, squares = 0.0;
  for (const double r : log_ratios) {
    const double w = std::exp(r - top);
    sum += w;
    squares += w * w;
  }
  const auto n = static_cast<double>(log_ratios.size());
  evidence.log_evidence = top + std::log(sum / n);
  evidence.standard_error = std::sqrt(std::max(0.0, (n * squares / (sum * sum) - 1.0) / (n - 1)));
  return evidence;
}

// ln (π / q) at a model's draws, an equal number of each chain.
ChainsOf log_ratios_at_draws(const RunState& state, int model) {
  constexpr std::size_t kLeast = 100;  // smallest number of draws per chain
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const ChainState& chain : state.chains) {
    const std::size_t n = chain.kept->of(model).size();
    if (n >= kLeast) least = std::min(least, n);
  }
  ChainsOf at_draws;
  if (least == std::numeric_limits<std::size_t>::max()) return at_draws;
  const NormalMixture& mixture = *state.pilot.fit->density[static_cast<std::size_t>(model)];
  for (const ChainState& chain : state.chains) {
    const KeptDraws::OfModel& kept = chain.kept->of(model);
    if (kept.size() < kLeast) continue;
    std::vector<double>& ratios = at_draws.emplace_back();
    for (std::size_t i = 0; i < least; ++i) {
      const std::size_t row = i * kept.size() / least;
      ratios.push_back(kept.log_posterior[row] - mixture.log_density(kept.row(row)));
    }
  }
  return at_draws;
}

// Bridge sampling between draws and mixture: ln Z, and the share of draws outside the mixture.
void find_by_bridge(const RunState& state, int model, const std::vector<double>& at_mixture,
                    ModelFindings& found) {
  const ChainsOf at_draws = log_ratios_at_draws(state, model);
  if (at_draws.empty()) return;
  const Bridge bridged = bridge(at_draws, at_mixture);
  if (!bridged.settled || !std::isfinite(bridged.log_evidence)) return;
  found.bridged.log_evidence = bridged.log_evidence;
  found.bridged.standard_error = bridged.standard_error;
  const double beyond = bridged.log_evidence + std::log(kLimits.beyond_mixture);
  ChainsOf is_beyond;
  for (const std::vector<double>& ratios : at_draws) {
    std::vector<double>& indicator = is_beyond.emplace_back();
    for (const double r : ratios) indicator.push_back(r > beyond ? 1.0 : 0.0);
  }
  found.beyond_mixture = mean(is_beyond);
  found.beyond_mixture_ess = ess_mean(is_beyond);
}

void describe_modes(const RunContext& run, const RunState& state, int model, ModelFindings& found) {
  const auto at = static_cast<std::size_t>(model);
  const CountedModes& of = state.weighty_modes[at];
  Target target(run.problem, true);
  for (std::size_t k = 0; k < of.modes.size(); ++k) {
    State there;
    there.model = model;
    there.z = of.modes[k].z;
    target.evaluate(there);
    FoundMode& mode = found.modes.emplace_back();
    mode.x = there.x;
    mode.log_posterior = of.modes[k].log_posterior;
    mode.climbs = of.modes[k].climbs;
    mode.share = of.shares[k];
    for (const ChainState& chain : state.chains) {
      const long visits = chain.kept->of(model).visits;
      mode.drawn.push_back(visits == 0 ? kNaN
                                       : static_cast<double>(chain.at_mode[at][k]) /
                                             static_cast<double>(visits));
    }
  }
}

}  // namespace

void weigh(RunContext& run, RunState& state) {
  if (run.options.prior_only) return;
  state.posterior.found.assign(run.models(), {});
  state.at_mixture.resize(run.models());
  for (int m = 0; m < run.space().size(); ++m) {
    const auto at = static_cast<std::size_t>(m);
    const ModelExploration& explored = state.explorations[at];
    ModelFindings& found = state.posterior.found[at];
    found.annealed = explored.annealed;
    found.climbs = explored.climbs;
    found.spacing = explored.spacing;
    found.glanced = explored.glanced;
    found.passed_over = explored.passed_over;
    found.pareto = explored.pareto;
    found.left_out = explored.left_out;
    found.left_out_share = explored.left_out_share;
    if (is_impossible(state, m)) {
      found.impossible = true;
      found.sampled = {.log_evidence = -kInfinity, .standard_error = 0.0};
      continue;
    }
    describe_modes(run, state, m, found);
    if (run.space()[m].dimension == 0) {
      found.sampled = explored.sampled;
      found.bridged = explored.sampled;
      continue;
    }
    // A model that was not evaluated has no fitted mixture. Draws near the median of its prior
    // would give an evidence that is far too low, with a small error.
    if (explored.passed_over && log_ratios_at_draws(state, m).empty()) continue;
    found.sampled = explored.sampled;
    // Most of many models were searched by climbs only; their low probability is not refined.
    const bool matters =
        (explored.population.cols() > 0 || run.space().size() <= kFewModels) &&
        !(explored.glanced && !explored.modes.empty() && state.probability[at] < kWorthWeighing);
    if (!matters || !run.options.evidences || !state.pilot.fit->density[at] ||
        run.monitor.stopped())
      continue;
    std::vector<double>& at_mixture = state.at_mixture[at];
    if (at_mixture.empty()) {
      long calls = 0;
      at_mixture =
          log_importance_ratios(run.problem, m, *state.pilot.fit->density[at],
                                run.options.quick ? kQuickDraws : kEvidenceDraws, run.options.seed,
                                run.options.threads, calls, [&] { return run.monitor.stopped(); });
      state.shared_evaluations += calls;
      state.posterior.calls.evidence += calls;
      run.monitor.evaluated(calls);
      if (run.monitor.stopped()) {
        at_mixture.clear();
        continue;
      }
    }
    // The importance sample of the exploration may have a smaller error.
    const ParetoTail tail = pareto_tail(at_mixture);
    const Evidence sampled = by_importance(at_mixture);
    const auto rank = [](const ParetoTail& of, const Evidence& evidence) {
      return std::pair(of.shape > kHeavyTail, evidence.standard_error);
    };
    if (!std::isfinite(explored.sampled.standard_error) ||
        rank(tail, sampled) < rank(explored.pareto, explored.sampled)) {
      found.sampled = sampled;
      found.pareto = tail;
    }
    find_by_bridge(state, m, at_mixture, found);
  }
}

}  // namespace wheeltap::inference
