#include "identification/sid/findings/sid_fit_verdict.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <functional>

#include "identification/sid/findings/free_cubic.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

// A large number: if the gap never closes in the window, few draws have the gap that the rest of
// the record requires.
constexpr std::size_t kDrawsBeyond = 400;
constexpr double kStillPossible = 0.05;  // probability

/// P(χ² of a replicate > χ² of the data) for the innovations, over a model's draws; NaN if no draw
/// was kept.
double predictive_p(const SidProblem& problem, const Posterior& posterior,
                    const SidPredictive& predictive, int model) {
  const SidModel& m = problem.sid_case.models[static_cast<std::size_t>(model)];
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  double sum = 0.0, draws = 0.0;
  for (const SidPredictive::Draw& draw : predictive.draws) {
    const inference::Chain& chain = posterior.chains[draw.chain];
    if (chain.model[draw.draw] != model) continue;
    const auto width = static_cast<std::size_t>(posterior.dimension);
    const std::vector<double> theta =
        problem.theta(model, {chain.theta.data() + draw.draw * width, width});
    double squares = 0.0, terms = 0.0;
    for (std::size_t c = 0; c < m.noise.size(); ++c) {
      const std::vector<double> r(
          draw.residuals.begin() + static_cast<std::ptrdiff_t>(c * samples),
          draw.residuals.begin() + static_cast<std::ptrdiff_t>((c + 1) * samples));
      const Innovations white = m.innovations(c, r, theta);
      for (const double e : white.values) {
        squares += e * e / white.variance;
        ++terms;
      }
    }
    sum += boost::math::gamma_q(0.5 * terms, 0.5 * squares);
    ++draws;
  }
  return draws > 0.0 ? sum / draws : std::nan("");
}

/// True if the residuals are not white; false if there are too few samples.
bool is_coloured(const std::optional<ResidualWhiteness>& whiteness) {
  return !whiteness || whiteness->test.p_value < kMisfit;
}

void judge_residuals(const SidProblem& problem, const std::vector<ChannelFit>& fits,
                     std::span<const double> theta, FitVerdict& verdict) {
  std::vector<double> free;
  bool asked = false;
  for (std::size_t c = 0; c < fits.size(); ++c) {
    const ChannelFit& fit = fits[c];
    if (!std::isfinite(fit.nrmse)) continue;
    if (fit.r2 < 0.5 && is_coloured(fit.plain_whiteness)) {
      verdict.why.emplace_back(misfit::Unexplained{.channel = fit.channel, .r2 = fit.r2});
      continue;
    }
    const bool loud = verdict.p < kMisfit;
    const bool coloured = fit.plain_whiteness && fit.plain_whiteness->test.p_value < kMisfit;
    if (!loud && !coloured) continue;
    // An autoregression can whiten any misfit, even one that contains most of the response.
    const bool taken_for_noise = !loud && fit.whiteness && fit.whiteness->test.p_value >= kMisfit;
    const bool large = fit.nrmse > kSmallResidual && !taken_for_noise;
    if (!large && !asked) {
      free = free_cubic_residual(problem, verdict.model, theta);
      asked = true;
    }
    const double of_free = c < free.size() ? free[c] : std::nan("");
    if (large || fit.nrmse > kMuchMoreThanFree * of_free) {
      verdict.why.emplace_back(
          misfit::NotNoise{.channel = fit.channel,
                           .share = fit.nrmse,
                           .share_of_free = of_free,
                           .lag = fit.whiteness ? fit.whiteness->worst_lag : 0,
                           .autocorrelation = fit.whiteness ? fit.whiteness->worst : std::nan("")});
    }
  }
}

/// Draws of a model, evenly spread over the kept draws.
std::vector<std::vector<double>> some_draws(const SidProblem& problem, const Posterior& posterior,
                                            const SidPredictive& predictive, int model) {
  std::vector<std::vector<double>> all;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  for (const SidPredictive::Draw& draw : predictive.draws) {
    const inference::Chain& chain = posterior.chains[draw.chain];
    if (chain.model[draw.draw] != model) continue;
    all.push_back(problem.theta(model, {chain.theta.data() + draw.draw * width, width}));
  }
  const std::size_t n = std::min(all.size(), kDrawsBeyond);
  for (std::size_t i = 0; i < n; ++i) all[i] = all[i * all.size() / n];
  all.resize(n);
  return all;
}

void judge_beyond(const SidProblem& problem, const std::vector<std::vector<double>>& draws,
                  const std::vector<ChannelFit>& inside, FitVerdict& verdict) {
  const auto rest = continuation(problem);
  if (!rest || draws.empty()) return;
  std::vector<double> least(inside.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> always_worse(inside.size(), true);
  for (const std::vector<double>& theta : draws) {
    if (std::ranges::count(always_worse, true) == 0) return;
    const std::vector<ChannelFit> fits = forward_run(*rest, verdict.model, theta);
    for (std::size_t c = 0; c < fits.size(); ++c) {
      const bool worse = fits[c].rmse > 2.0 * inside[c].rmse &&
                         fits[c].nrmse > 2.0 * inside[c].nrmse && fits[c].nrmse > kSmallResidual;
      always_worse[c] = always_worse[c] && worse;
      least[c] = std::min(least[c], fits[c].nrmse);
    }
  }
  for (std::size_t c = 0; c < inside.size(); ++c) {
    if (!always_worse[c] || !std::isfinite(least[c])) continue;
    verdict.why.emplace_back(misfit::WorseBeyond{.channel = inside[c].channel,
                                                 .inside = inside[c].nrmse,
                                                 .beyond = least[c],
                                                 .samples = problem.sid_case.beyond});
  }
}

FitVerdict judge_model(const SidProblem& problem, const Posterior& posterior,
                       const SidPredictive& predictive, const SidFindings& findings, int model) {
  FitVerdict verdict;
  verdict.model = model;
  const SidModelFinding& found = *findings.of_models[static_cast<std::size_t>(model)];
  const auto count = [&](const std::vector<ChannelFit>& fits) {
    for (const ChannelFit& fit : fits) {
      if (std::isfinite(fit.r2)) verdict.r2 = std::fmin(verdict.r2, fit.r2);
    }
  };
  count(found.at_best);
  for (const auto& fits : found.further) count(fits);
  verdict.p = predictive_p(problem, posterior, predictive, model);
  const auto theta = problem.theta(model, found.best_draw);
  const auto draws = some_draws(problem, posterior, predictive, model);
  judge_residuals(problem, found.at_best, theta, verdict);
  judge_beyond(problem, draws, found.at_best, verdict);
  for (std::size_t r = 0; r < problem.further.size(); ++r) {
    judge_residuals(*problem.further[r], found.further[r], theta, verdict);
    judge_beyond(*problem.further[r], draws, found.further[r], verdict);
  }
  return verdict;
}

}  // namespace

FitVerdict judge_fit(const SidProblem& problem, const Posterior& posterior,
                     const SidPredictive& predictive, const SidFindings& findings) {
  std::vector<int> list;
  const auto probability = [&](int m) {
    return findings.models[static_cast<std::size_t>(m)].probability();
  };
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    if (findings.of_models[m]) list.push_back(static_cast<int>(m));
  }
  std::ranges::stable_sort(list, std::ranges::greater{}, probability);
  if (list.empty()) return {};
  FitVerdict of_best = judge_model(problem, posterior, predictive, findings, list.front());
  if (of_best.ok()) return of_best;
  for (std::size_t i = 1; i < list.size() && probability(list[i]) >= kStillPossible; ++i) {
    FitVerdict other = judge_model(problem, posterior, predictive, findings, list[i]);
    if (!other.ok()) continue;
    other.instead_of = of_best.model;
    other.why_not = std::move(of_best.why);
    return other;
  }
  return of_best;
}

}  // namespace wheeltap::identification
