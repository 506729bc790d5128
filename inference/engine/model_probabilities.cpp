#include "inference/engine/model_probabilities.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kTrustedDraws = 50.0;  // effective draws of an importance sample
constexpr long kLadderVisits = 50;      // smallest number per chain, for a reference model
constexpr double kLeastLog = -700.0;    // ln of a negligible probability

double visits_of(const ChainState& chain, std::size_t model) {
  return static_cast<double>(chain.by_rung.back().visits(static_cast<int>(model)));
}

void normalise(RunState& state) {
  state.probability.assign(state.log_probability.size(), 0.0);
  double sum = 0.0;
  for (std::size_t m = 0; m < state.probability.size(); ++m)
    sum += state.probability[m] = std::exp(state.log_probability[m]);
  for (double& p : state.probability) p /= sum;
}

// Estimates ln Z of each model from the ladder, relative to a model with an accurate ln Z by
// importance sampling. The scatter of the estimates of the chains gives the standard error.
void anneal_by_ladder(const RunContext& run, RunState& state) {
  const std::size_t models = run.models();
  std::vector<ModelExploration>& explorations = state.explorations;
  std::size_t anchor = models;
  for (std::size_t m = 0; m < models; ++m) {
    if (!(explorations[m].effective_draws > kTrustedDraws)) continue;
    if (std::ranges::any_of(state.chains, [&](const ChainState& chain) {
          return chain.by_rung.back().visits(static_cast<int>(m)) < kLadderVisits;
        }))
      continue;
    if (anchor == models || explorations[m].effective_draws > explorations[anchor].effective_draws)
      anchor = m;
  }
  const auto chains = static_cast<double>(state.chains.size());
  if (anchor == models || state.chains.size() < 4) return;
  const auto log_mass = [&](const ChainState& chain, std::size_t m) {
    return std::log(visits_of(chain, m)) - chain.ladder->weights.back()[m] -
           run.space()[static_cast<int>(m)].log_prior;
  };
  for (std::size_t m = 0; m < models; ++m) {
    if (m == anchor || std::isfinite(explorations[m].annealed.log_evidence)) continue;
    double sum = 0.0, squares = 0.0;
    for (const ChainState& chain : state.chains) {
      const double difference = log_mass(chain, m) - log_mass(chain, anchor);
      sum += difference;
      squares += difference * difference;
    }
    const double mean = sum / chains;
    if (!std::isfinite(mean)) continue;  // some chain did not visit the model
    const double variance = std::max(0.0, squares / chains - mean * mean) / (chains - 1.0);
    Evidence& annealed = explorations[m].annealed;
    annealed.log_evidence = explorations[anchor].sampled.log_evidence + mean;
    // Student's t, as for TMCMC's replicates (tmcmc.hpp)
    annealed.standard_error = std::sqrt(variance * (chains - 1.0) / (chains - 3.0));
  }
}

}  // namespace

void estimate_probabilities(const RunContext& run, RunState& state) {
  const std::size_t models = run.models();
  const bool laddered = !state.by_rung.empty();
  std::vector<double> by_ladder(models, kNaN), by_evidence(models, kNaN);
  for (std::size_t m = 0; m < models; ++m) {
    const double evidence = state.explorations[m].log_evidence();
    if (std::isfinite(evidence))
      by_evidence[m] = run.space()[static_cast<int>(m)].log_prior + evidence;
  }
  if (laddered) {
    // The numbers of visits, corrected for the adapted weights.
    for (std::size_t m = 0; m < models; ++m) {
      double sum = -kInfinity;
      for (const ChainState& chain : state.chains) {
        const double visits = visits_of(chain, m);
        if (visits > 0.0)
          sum = log_sum_exp(sum, std::log(visits) - chain.ladder->weights.back()[m]);
      }
      by_ladder[m] = sum;
    }
  }
  // If importance sampling failed, the ladder is more reliable than Laplace's method.
  double shift = 0.0, known = 0.0;
  const auto sampled_well = [&](std::size_t m) {
    return state.explorations[m].effective_draws > kTrustedDraws && std::isfinite(by_evidence[m]);
  };
  for (std::size_t m = 0; m < models; ++m) {
    if (!std::isfinite(by_ladder[m]) || !sampled_well(m)) continue;
    shift += by_evidence[m] - by_ladder[m];
    known += 1.0;
  }
  if (known > 0.0) shift /= known;
  if (laddered) anneal_by_ladder(run, state);
  double top = -kInfinity;
  state.log_probability.resize(models);
  for (std::size_t m = 0; m < models; ++m) {
    const bool by_its_own = !std::isfinite(by_ladder[m]) || (known > 0.0 && sampled_well(m));
    double& p = state.log_probability[m] = by_its_own ? by_evidence[m] : by_ladder[m] + shift;
    if (std::isnan(p)) p = -kInfinity;
    top = std::max(top, p);
  }
  for (double& p : state.log_probability) p = std::max(p - top, kLeastLog);
  normalise(state);
}

void take_prior_probabilities(const RunContext& run, RunState& state) {
  state.log_probability.clear();
  for (const Model& model : run.space().models())
    state.log_probability.push_back(std::max(kLeastLog, model.log_prior));
  normalise(state);
}

void learn_probabilities(RunState& state, const PilotSamples& last_round) {
  constexpr double kEnough = 30.0;  // visits
  if (state.tuning_bias.empty()) return;
  std::vector<double>& log_probability = state.log_probability;
  const std::vector<double>& bias = state.tuning_bias;
  const std::size_t models = log_probability.size();
  double visited = -kInfinity, before = -kInfinity, all = -kInfinity;
  for (std::size_t m = 0; m < models; ++m) all = log_sum_exp(all, log_probability[m] + bias[m]);
  std::vector<double> by_visits(models, kNaN);
  for (std::size_t m = 0; m < models; ++m) {
    const auto visits = static_cast<double>(last_round.visits(static_cast<int>(m)));
    const double expected =
        std::exp(log_probability[m] + bias[m] - all) * static_cast<double>(last_round.total());
    if (visits < kEnough && expected < kEnough) continue;
    by_visits[m] = std::log(visits + 0.5) - bias[m];
    visited = log_sum_exp(visited, by_visits[m]);
    before = log_sum_exp(before, log_probability[m]);
  }
  if (!std::isfinite(visited)) return;  // too few visits to learn from
  if (!std::isfinite(before)) before = visited;
  for (std::size_t m = 0; m < models; ++m)
    log_probability[m] =
        std::isfinite(by_visits[m]) ? by_visits[m] - visited : log_probability[m] - before;
  const double top = *std::ranges::max_element(log_probability);
  for (double& p : log_probability) p = std::isfinite(p) ? std::max(p - top, kLeastLog) : kLeastLog;
  normalise(state);
}

}  // namespace wheeltap::inference
