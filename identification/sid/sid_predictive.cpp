#include "identification/sid/sid_predictive.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/findings/marginal.hpp"

namespace wheeltap::identification {
namespace {

constexpr std::size_t kMaxPredicted = 6'000'000;
constexpr int kFewestDraws = 20;

// Systematic resampling: index at which the cumulative weight exceeds this share of the total.
std::size_t reached(const std::vector<double>& weights, double share) {
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    if (sum > wanted) return i;
  }
  return weights.size() - 1;
}

}  // namespace

SidPredictive predict(const SidProblem& problem, const inference::Posterior& posterior, int draws) {
  const std::size_t length = problem.sid_case.responses().size() *
                             static_cast<std::size_t>(problem.misfits.front().samples());
  const std::size_t chains = posterior.chains.size();
  const auto affordable = static_cast<int>(kMaxPredicted / std::max<std::size_t>(length, 1));
  const auto wanted = static_cast<std::size_t>(std::max(kFewestDraws, std::min(draws, affordable)));
  const std::size_t each = std::max<std::size_t>(1, wanted / chains);
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const inference::ChainsOf weights = draw_weights(posterior);
  SidPredictive out;
  std::vector<double> residuals(length);
  for (std::size_t c = 0; c < chains; ++c) {
    const auto& chain = posterior.chains[c];
    for (std::size_t j = 0; j < each; ++j) {
      const std::size_t i =
          weights.empty()
              ? (2 * j + 1) * chain.model.size() / (2 * each)
              : reached(weights[c], (static_cast<double>(j) + 0.5) / static_cast<double>(each));
      const int m = chain.model[i];
      const auto theta = problem.theta(m, {chain.theta.data() + i * width, width});
      if (!problem.misfits[static_cast<std::size_t>(m)].residuals(theta, residuals)) continue;
      SidPredictive::Draw draw{.chain = c, .draw = i, .residuals = {}, .noise = {}};
      draw.residuals.assign(residuals.begin(), residuals.end());
      for (const auto& sd : problem.sid_case.models[static_cast<std::size_t>(m)].noise) {
        draw.noise.push_back(sd.at(theta));
      }
      out.draws.push_back(std::move(draw));
    }
  }
  return out;
}

std::vector<double> observed(const SidProblem& problem, std::size_t response,
                             std::span<const double> theta) {
  const SidChannel& channel = *problem.sid_case.responses()[response];
  const double scale = channel.signal.scale.at(theta), offset = channel.signal.offset.at(theta);
  std::vector<double> y;
  for (std::size_t n = static_cast<std::size_t>(problem.sid_case.lead_in);
       n < channel.signal.samples.size(); ++n) {
    y.push_back(scale * channel.signal.samples[n] + offset);
  }
  return y;
}

std::vector<NoiseFree> noise_free(const SidProblem& problem, const inference::Posterior& posterior,
                                  const SidPredictive& predictive) {
  const std::size_t responses = problem.sid_case.responses().size();
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const auto width = static_cast<std::size_t>(posterior.dimension);
  if (predictive.draws.empty()) return {};
  std::vector<NoiseFree> out(responses);
  for (std::size_t c = 0; c < responses; ++c) {
    std::vector<std::vector<double>> at(samples);  // predictions of all draws, per sample
    for (const auto& d : predictive.draws) {
      const auto& chain = posterior.chains[d.chain];
      const auto theta =
          problem.theta(chain.model[d.draw], {chain.theta.data() + d.draw * width, width});
      const std::vector<double> y = observed(problem, c, theta);
      for (std::size_t n = 0; n < samples; ++n) {
        at[n].push_back(y[n] - static_cast<double>(d.residuals[c * samples + n]));
      }
    }
    for (std::vector<double>& predicted : at) {
      std::ranges::sort(predicted);
      out[c].q2_5.push_back(quantile(predicted, 0.025));
      out[c].q50.push_back(quantile(predicted, 0.5));
      out[c].q97_5.push_back(quantile(predicted, 0.975));
    }
  }
  return out;
}

std::vector<double> coverage(const SidProblem& problem, const SidPredictive& predictive) {
  const std::size_t responses = problem.sid_case.responses().size();
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const double tail = 0.5 * (1.0 - problem.sid_case.band);
  std::vector<double> out;
  for (std::size_t c = 0; c < responses; ++c) {
    long inside = 0;
    for (std::size_t n = 0; n < samples; ++n) {
      double p = 0.0;
      for (const auto& draw : predictive.draws) {
        p += 0.5 * std::erfc(-draw.residuals[c * samples + n] / (draw.noise[c] * M_SQRT2));
      }
      p /= static_cast<double>(predictive.draws.size());
      inside += p >= tail && p <= 1.0 - tail ? 1 : 0;
    }
    out.push_back(static_cast<double>(inside) / static_cast<double>(samples));
  }
  return out;
}

}  // namespace wheeltap::identification
