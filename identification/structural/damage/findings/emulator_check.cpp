#include "identification/structural/damage/findings/emulator_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/findings/marginal.hpp"
#include "inference/evidence/importance_sampling.hpp"

namespace wheeltap::identification {
namespace {

struct Checked {
  int model;
  std::span<const double> theta;
  double plain;   // weight in the posterior, normalised
  double weight;  // weight in the FE posterior
};

// Reweighted and plain mean of f, with sums for the standard error of their difference.
struct Means {
  double plain = 0.0, weighted = 0.0, error = 0.0;
};

template <class Value>
Means means(const std::vector<Checked>& draws, const Value& value) {
  Means m;
  for (const Checked& d : draws) {
    m.plain += d.plain * value(d);
    m.weighted += d.weight * value(d);
  }
  // standard error of the difference: delta method for a ratio estimator
  for (const Checked& d : draws) {
    const double term = (d.weight - d.plain) * (value(d) - m.weighted);
    m.error += term * term;
  }
  m.error = std::sqrt(m.error);
  return m;
}

constexpr double kWorthComparing = 0.05;  // least model probability to compare parameters
constexpr double kMovedProbability = 0.02;
constexpr double kMovedMean = 0.25;  // in sd
constexpr double kSure = 3.0;        // standard errors

}  // namespace

std::optional<EmulatorCheck> check_emulator(const DamageProblem& problem,
                                            const inference::Posterior& posterior, int most) {
  // An emulator has no effect on a run that evaluates no likelihood.
  if (!problem.emulator || problem.exact() || posterior.likelihood_evaluations == 0) return {};
  const FrequencyData& data = problem.damage_case.data;
  const auto modes = static_cast<std::size_t>(data.modes());
  const auto all = static_cast<std::size_t>(posterior.draws) * posterior.chains.size();
  const std::size_t stride = std::max<std::size_t>(1, all / static_cast<std::size_t>(most));
  const auto likelihood = problem.fe_likelihood();
  std::vector<Checked> draws;
  const std::vector<double> of_model = model_weights(posterior);
  std::vector<double> log_weights, squares(modes, 0.0), largest(modes, 0.0);
  StructuralPredictor predictor(problem, *problem.emulated);
  const NoiseModel noise_model = problem.noise();
  std::vector<double> emulated(modes);
  inference::Evaluation fe;
  long compared = 0;
  for (std::size_t n = 0; n < all; n += stride) {
    const auto& chain = posterior.chains[n / static_cast<std::size_t>(posterior.draws)];
    const std::size_t i = n % static_cast<std::size_t>(posterior.draws);
    const std::span<const double> x =
        posterior.theta(n / static_cast<std::size_t>(posterior.draws), i);
    likelihood->evaluate(-std::numeric_limits<double>::infinity(), chain.model[i], x, fe);
    draws.push_back({chain.model[i], x, of_model[static_cast<std::size_t>(chain.model[i])], 0.0});
    log_weights.push_back(fe.log_likelihood - chain.log_likelihood[i]);
    if (problem.problem.space[chain.model[i]].counts[0] == 0) continue;
    ++compared;
    predictor.solve(chain.model[i], x, emulated);
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isnan(data.frequencies_hz[mode])) continue;
      const double error = emulated[mode] - fe.prediction[mode];
      const double noise = noise_model.sd(mode, noise_model.cv(x), 0.0);
      squares[mode] += error * error / (noise * noise);
      largest[mode] = std::max(largest[mode], std::abs(error) / noise);
    }
  }
  const double top = *std::ranges::max_element(log_weights);
  double sum = 0.0, sum_squares = 0.0, mean = 0.0, square = 0.0, plain = 0.0, plain_squares = 0.0;
  for (std::size_t n = 0; n < draws.size(); ++n) {
    draws[n].weight = draws[n].plain * std::exp(log_weights[n] - top);
    sum += draws[n].weight;
    plain += draws[n].plain;
    mean += log_weights[n] / static_cast<double>(draws.size());
  }
  for (std::size_t n = 0; n < draws.size(); ++n) {
    draws[n].weight /= sum;
    draws[n].plain /= plain;
    sum_squares += draws[n].weight * draws[n].weight;
    plain_squares += draws[n].plain * draws[n].plain;
    square += (log_weights[n] - mean) * (log_weights[n] - mean);
  }
  const auto n = static_cast<double>(draws.size());
  const double share = plain_squares / sum_squares;
  const double pareto = inference::pareto_shape(log_weights);
  EmulatorCheck out{.draws = static_cast<int>(draws.size()),
                    .mean_log_weight = mean,
                    .sd_log_weight = std::sqrt(square / n),
                    .effective_share = share,
                    .pareto_shape = pareto,
                    .conclusive = !(pareto > 0.7) && share * n >= 50.0,
                    .models = {},
                    .moved = {},
                    .error_to_noise = {}};
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    const Means p = means(draws, [&](const Checked& d) { return d.model == m ? 1.0 : 0.0; });
    const Shift shift{p.plain, p.weighted, p.error};
    out.models.push_back({.probability = shift, .compared = false, .means = {}});
    const double size = std::abs(p.weighted - p.plain);
    if (size > kMovedProbability && size > kSure * p.error) out.moved.push_back({m, -1, shift});
  }
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    std::vector<Checked> within;
    double total = 0.0, of_plain = 0.0;
    for (const Checked& d : draws) {
      if (d.model != m) continue;
      within.push_back(d);
      total += d.weight;
      of_plain += d.plain;
    }
    if (of_plain < kWorthComparing || !(total > 0.0)) continue;
    for (Checked& d : within) d.weight /= total, d.plain /= of_plain;
    out.models[static_cast<std::size_t>(m)].compared = true;
    for (int p = 0; p < problem.problem.space[m].dimension; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const Means value = means(within, [&](const Checked& d) { return d.theta[at]; });
      const Means squared =
          means(within, [&](const Checked& d) { return d.theta[at] * d.theta[at]; });
      const double sd = std::sqrt(std::max(0.0, squared.plain - value.plain * value.plain));
      const Shift shift{value.plain, value.weighted, value.error};
      out.models[static_cast<std::size_t>(m)].means.push_back(shift);
      const double size = std::abs(value.weighted - value.plain);
      if (size > kMovedMean * sd && size > kSure * value.error) out.moved.push_back({m, p, shift});
    }
  }
  std::size_t worst = 0;
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const double rms =
        compared > 0 ? std::sqrt(squares[mode] / static_cast<double>(compared)) : 0.0;
    out.error_to_noise.push_back({rms, largest[mode]});
    if (squares[mode] > squares[worst]) worst = mode;
  }
  out.worst_mode = static_cast<int>(worst) + 1;
  return out;
}

}  // namespace wheeltap::identification
