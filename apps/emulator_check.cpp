#include "apps/emulator_check.hpp"

#include <algorithm>
#include <cmath>

#include "inference/evidence/importance_sampling.hpp"

namespace wheeltap::apps {
namespace {

struct Checked {
  int model;
  std::span<const double> theta;
  double plain;   // weight in the posterior, normalised
  double weight;  // in the FE's
};

// Σ w (f - mean)² of the reweighted mean and of the plain one, for the error of their difference.
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
  // ratio estimator's delta method, for the difference (w - plain)(f - weighted mean)
  for (const Checked& d : draws) {
    const double term = (d.weight - d.plain) * (value(d) - m.weighted);
    m.error += term * term;
  }
  m.error = std::sqrt(m.error);
  return m;
}

constexpr double kWorthTelling = 0.05;  // probability of a model whose parameters are compared
constexpr double kMovedProbability = 0.02;
constexpr double kMovedMean = 0.25;  // in sd
constexpr double kSure = 3.0;        // standard errors

}  // namespace

Report check_emulator(const DamageProblem& problem, const inference::Posterior& posterior,
                      std::vector<std::string>& warnings, int most) {
  // Without the likelihood there is nothing that an emulator could move.
  if (!problem.emulator || problem.exact() || posterior.likelihood_evaluations == 0) return {};
  const FrequencyData& data = problem.damage_case.data;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const auto modes = static_cast<std::size_t>(data.modes());
  const auto all = static_cast<std::size_t>(posterior.draws) * posterior.chains.size();
  const std::size_t stride = std::max<std::size_t>(1, all / static_cast<std::size_t>(most));
  const auto likelihood = problem.fe_likelihood();
  std::vector<Checked> draws;
  const std::vector<double> of_model = model_weights(posterior);
  std::vector<double> log_weights, squares(modes, 0.0), largest(modes, 0.0);
  FrequencyPredictor predictor(problem);
  std::vector<double> emulated(modes), ignored(modes);
  long compared = 0;
  for (std::size_t n = 0; n < all; n += stride) {
    const auto& chain = posterior.chains[n / static_cast<std::size_t>(posterior.draws)];
    const std::size_t i = n % static_cast<std::size_t>(posterior.draws);
    const std::span<const double> x(chain.theta.data() + i * width, width);
    const double log_fe = likelihood->log_likelihood(chain.model[i], x);
    draws.push_back({chain.model[i], x, of_model[static_cast<std::size_t>(chain.model[i])], 0.0});
    log_weights.push_back(log_fe - chain.log_likelihood[i]);
    if (problem.problem.space[chain.model[i]].counts[0] == 0) continue;
    ++compared;
    predictor.emulate(chain.model[i], x, emulated, ignored);
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isnan(data.frequencies_hz[mode])) continue;
      const double error = emulated[mode] - likelihood->prediction()[mode];
      const double noise = problem.total_sd(mode, data.cov_prior ? x[0] : 0.0, 0.0);
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
  const bool telling = !(pareto > 0.7) && share * n >= 50.0;

  Report models = Report::array();
  std::vector<std::string> moved;
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    const Means p = means(draws, [&](const Checked& d) { return d.model == m ? 1.0 : 0.0; });
    const std::string& name = problem.problem.space[m].name;
    models.push_back(
        {{"name", name}, {"emulator", p.plain}, {"fe", p.weighted}, {"standard_error", p.error}});
    const double shift = std::abs(p.weighted - p.plain);
    if (shift > kMovedProbability && shift > kSure * p.error) {
      moved.push_back("P(" + name + ") is " + percent(p.weighted) + " and not " + percent(p.plain));
    }
  }
  Report parameters = Report::object();
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    std::vector<Checked> within;
    double total = 0.0, of_plain = 0.0;
    for (const Checked& d : draws) {
      if (d.model != m) continue;
      within.push_back(d);
      total += d.weight;
      of_plain += d.plain;
    }
    if (of_plain < kWorthTelling || !(total > 0.0)) continue;
    for (Checked& d : within) d.weight /= total, d.plain /= of_plain;
    Report& table = parameters[problem.problem.space[m].name] = Report::object();
    for (int p = 0; p < problem.problem.space[m].dimension; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const Means value = means(within, [&](const Checked& d) { return d.theta[at]; });
      const Means squared =
          means(within, [&](const Checked& d) { return d.theta[at] * d.theta[at]; });
      const double sd = std::sqrt(std::max(0.0, squared.plain - value.plain * value.plain));
      const std::string label = parameter_label(problem.problem.space, m, p);
      table[label] = {
          {"emulator", value.plain}, {"fe", value.weighted}, {"standard_error", value.error}};
      const double shift = std::abs(value.weighted - value.plain);
      if (shift > kMovedMean * sd && shift > kSure * value.error) {
        moved.push_back("the mean of " + label + " with " + problem.problem.space[m].name + " is " +
                        significant(value.weighted, 3) + " and not " + significant(value.plain, 3));
      }
    }
  }
  Report by_mode = Report::array();
  std::size_t worst = 0;
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const double rms =
        compared > 0 ? std::sqrt(squares[mode] / static_cast<double>(compared)) : 0.0;
    by_mode.push_back({{"mode", mode + 1}, {"rms", rms}, {"largest", largest[mode]}});
    if (squares[mode] > squares[worst]) worst = mode;
  }
  const Report& at_worst = by_mode[worst];
  const std::string error_there =
      "At these draws its error is " + significant(at_worst["rms"].get<double>(), 2) +
      " times the noise in mode " + std::to_string(worst + 1) + ", its worst";
  const std::string remedy =
      ". Use \"predictor\": \"fe\", add \"exact\": true, or choose a better emulator "
      "(docs/emulators.md).";
  if (!telling) {
    warnings.push_back(
        "The emulator moved the answer, by more than its draws can tell: of " +
        std::to_string(draws.size()) +
        " draws checked with the FE solution, the FE's likelihood puts its weight on "
        "some " +
        rounded_count(std::max(1.0, share * n)) + ". " + error_there + remedy);
  } else if (!moved.empty()) {
    std::string text;
    for (std::size_t i = 0; i < moved.size() && i < 4; ++i) text += (i ? "; " : "") + moved[i];
    warnings.push_back("The emulator moved the answer. By the FE solution " + text + " (" +
                       std::to_string(draws.size()) + " draws checked). " + error_there + remedy);
  }
  return {{"draws", draws.size()},
          {"mean_log_weight", mean},
          {"sd_log_weight", std::sqrt(square / n)},
          {"effective_share", share},
          {"pareto_shape", std::isfinite(pareto) ? Report(pareto) : Report()},
          {"conclusive", telling},
          {"moved", !telling || !moved.empty()},
          {"models", models},
          {"parameters", parameters},
          {"error_to_noise", by_mode},
          {"worst_mode", worst + 1}};
}

}  // namespace wheeltap::apps
