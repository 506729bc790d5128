#include "identification/sid/sid_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

/// Whiteness of residuals, or of innovations of a residual model with `fitted` parameters.
std::optional<ResidualWhiteness> whiteness(std::span<const double> white, bool of_innovations,
                                           int fitted) {
  const int lags = std::clamp(static_cast<int>(white.size()) / 5, 2, 20) + fitted;
  if (static_cast<int>(white.size()) <= lags + 1) return {};
  const std::vector<double> rho = signals::autocorrelation(white, lags);
  const auto worst =
      std::ranges::max_element(rho, {}, [](double x) { return std::abs(x); }) - rho.begin();
  return ResidualWhiteness{.of_innovations = of_innovations,
                           .lags = lags,
                           .test = signals::ljung_box(white, lags, fitted),
                           .lag_1 = rho[0],
                           .worst_lag = static_cast<int>(worst) + 1,
                           .worst = rho[static_cast<std::size_t>(worst)]};
}

/// Fit statistics of the residuals r of a response y [SI].
ChannelFit fit_of(const SidChannel& channel, std::span<const double> r, std::span<const double> y,
                  const SidModel& model, std::size_t c, std::span<const double> theta) {
  const auto n = static_cast<double>(r.size());
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double squares = 0.0, total = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    squares += r[i] * r[i];
    total += (y[i] - mean) * (y[i] - mean);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {.channel = channel.name(),
          .mass = channel.mass,
          .mse = squares / n,
          .rmse = std::sqrt(squares / n),
          .nrmse = total > 0.0 ? std::sqrt(squares / total) : nan,
          .r2 = total > 0.0 ? 1.0 - squares / total : nan,
          .noise_sd = model.noise[c].at(theta),
          .whiteness =
              whiteness(model.innovations(c, r, theta).values, !model.residuals.model->is_white(),
                        static_cast<int>(model.residuals.at(c, theta).size())),
          .plain_whiteness = whiteness(r, false, 0)};
}

}  // namespace

std::vector<ChannelFit> forward_run(const SidProblem& problem, int m,
                                    std::span<const double> theta) {
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
  const auto samples = static_cast<std::size_t>(misfit.samples());
  const auto responses = problem.sid_case.responses();
  std::vector<double> residuals(responses.size() * samples);
  std::vector<ChannelFit> out;
  if (!misfit.residuals(theta, residuals)) return out;
  for (std::size_t c = 0; c < responses.size(); ++c) {
    out.push_back(fit_of(*responses[c], {residuals.data() + c * samples, samples},
                         observed(problem, c, theta), model, c, theta));
  }
  return out;
}

std::unique_ptr<const SidProblem> continuation(const SidProblem& problem) {
  if (problem.sid_case.beyond == 0) return nullptr;
  SidCase rest = problem.sid_case;
  rest.further.clear();
  for (SidChannel& channel : rest.channels) {
    auto& samples = channel.signal.samples;
    samples.insert(samples.end(), channel.beyond.begin(), channel.beyond.end());
    channel.beyond.clear();
  }
  rest.lead_in += rest.end - rest.begin;
  rest.begin = rest.end;
  rest.end += std::exchange(rest.beyond, 0);
  return make_sid_problem(std::move(rest));
}

std::vector<double> mean_draw(const SidProblem& problem, const Posterior& posterior, int model) {
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<double> mean(static_cast<std::size_t>(problem.problem.space[model].dimension));
  double draws = 0.0;
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      if (chain.model[i] != model) continue;
      ++draws;
      for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += chain.theta[i * width + p];
    }
  }
  for (double& x : mean) x /= std::max(draws, 1.0);
  return mean;
}

std::span<const double> best_draw(const SidProblem& problem, const Posterior& posterior,
                                  int model) {
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::span<const double> best;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      const double density = chain.log_prior[i] + chain.log_likelihood[i];
      if (chain.model[i] != model || !(density > most)) continue;
      most = density;
      best = {&chain.theta[i * width],
              static_cast<std::size_t>(problem.problem.space[model].dimension)};
    }
  }
  return best;
}

std::vector<double> posterior_mean(const SidProblem& problem, const Posterior& posterior,
                                   int model) {
  return problem.theta(model, mean_draw(problem, posterior, model));
}

std::optional<double> step_error(const SidProblem& problem, const Posterior& posterior, int m) {
  constexpr int kFiner = 4;
  const auto theta = problem.theta(m, best_draw(problem, posterior, m));
  const SidModel& model = problem.sid_case.models[static_cast<std::size_t>(m)];
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
  const dynamics::Simulator& simulator = misfit.simulator();
  if (simulator.substeps(theta) <= 0) return {};  // exact
  if (simulator.options().substeps > dynamics::kMaxSubsteps / kFiner) return {};
  const dynamics::Misfit finer = misfit.refined(kFiner);
  const auto samples = static_cast<std::size_t>(misfit.samples());
  const auto channels = static_cast<std::size_t>(misfit.channels());
  std::vector<double> residuals(channels * samples), better(channels * samples);
  if (!misfit.residuals(theta, residuals) || !finer.residuals(theta, better)) return {};
  for (std::size_t i = 0; i < better.size(); ++i) better[i] -= residuals[i];
  double sum = 0.0;
  for (std::size_t c = 0; c < channels; ++c) {
    const Innovations change = model.innovations(c, {better.data() + c * samples, samples}, theta);
    for (const double value : change.values) sum += value * value / change.variance;
  }
  return std::sqrt(sum);
}

}  // namespace wheeltap::identification
