#include "identification/monitoring/baseline_learning.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/random.hpp"
#include "identification/monitoring/baseline_training.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace training;  // NOLINT(google-build-using-namespace): its only user

// Variance of the slow drift: a short period cannot rule it out.
constexpr double kLeastSlow = 0.5, kMostSlow = 10.0;
constexpr double kLargestRhat = 1.1;
constexpr long kManyEntries = 20'000;
constexpr double kLeastFast = 1e-3, kMostFast = 1e2;               // variance of the fast drift
constexpr double kShortestDrift = 0.5, kLongestDrift = 30.0 * 24;  // time constant, hours
constexpr double kShortestLag = 0.1, kLongestLag = 72.0;           // hours

class LearningLikelihood final : public inference::Likelihood {
 public:
  LearningLikelihood(const TrainingRows& of, Layout layout) : of_(of), layout_(layout) {}
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    return log_evidence(of_, layout_, x);
  }

 private:
  const TrainingRows& of_;
  Layout layout_;
};

inference::ModelSpace space_of(const TrainingRows& of) {
  using inference::LogUniform;
  std::vector<inference::Parameter> common;
  if (of.lag) common.push_back({"lag", LogUniform{.lower = kShortestLag, .upper = kLongestLag}});
  common.push_back({"time constant", LogUniform{.lower = kShortestDrift, .upper = kLongestDrift}});
  common.push_back({"slow ratio", LogUniform{.lower = kLeastSlow, .upper = kMostSlow}});
  for (std::size_t j = 0; j < of.features.size(); ++j)
    common.push_back({"fast ratio " + std::to_string(j + 1),
                      LogUniform{.lower = kLeastFast, .upper = kMostFast}});
  if (of.most_hinges == 0) {
    std::vector<std::string> names;
    for (const auto& p : common) names.push_back(p.name);
    return inference::ModelSpace::of_models(common, {{"0 hinges", 1.0, names}});
  }
  std::vector<inference::ModelSpace::Counts> counts;
  for (int k = 0; k <= of.most_hinges; ++k) counts.push_back({{k}, 1.0});
  return inference::ModelSpace::of_components(
      common,
      {{"hinge",
        "hinges",
        {{"knot",
          inference::Uniform{.lower = 0.0, .upper = static_cast<double>(of.hinged.size())}}}}},
      counts);
}

/// Degrees of freedom, and index of a correlation.
struct TailChoice {
  double degrees;
  std::size_t correlation;
  double log_evidence;
};

const TailChoice& draw_choice(const std::vector<TailChoice>& choices, base::Random& random) {
  double top = -kInfinity, sum = 0.0;
  for (const TailChoice& c : choices) top = std::max(top, c.log_evidence);
  for (const TailChoice& c : choices) sum += std::exp(c.log_evidence - top);
  double left = random.uniform() * sum;
  for (const TailChoice& c : choices)
    if ((left -= std::exp(c.log_evidence - top)) <= 0.0) return c;
  return choices.back();
}

/// Possible correlations of the drift: none, the estimate and half of it, and one that is common to
/// all pairs of features.
std::vector<MatrixXd> possible_correlations(const MatrixXd& estimate) {
  const Index p = estimate.rows();
  const MatrixXd one = MatrixXd::Identity(p, p);
  std::vector<MatrixXd> out = {one};
  if (p == 1) return out;
  for (const double share : {0.5, 1.0}) out.emplace_back(share * estimate + (1.0 - share) * one);
  for (const double r : {0.25, 0.5, 0.75, 0.9})
    out.emplace_back(MatrixXd::Constant(p, p, r) + (1.0 - r) * one);
  return out;
}

/// The full filter's evidence over degrees of freedom for uncorrelated drift, then over
/// correlations for each draw of the degrees.
class TailChoices {
 public:
  TailChoices(const TrainingRows& of, const std::vector<Row>& rows, BaselineDraw draw,
              const std::vector<MatrixXd>& correlations)
      : of_(of), rows_(rows), draw_(std::move(draw)), correlations_(correlations) {
    for (const double degrees : {3.0, 5.0, 8.0, 15.0, 40.0, kGaussian})
      degrees_.push_back(evidence(degrees, 0));
  }
  TailChoice draw(base::Random& random) {
    const TailChoice degrees = draw_choice(degrees_, random);
    std::vector<TailChoice>& choices = choices_[degrees.degrees];
    if (choices.empty()) {
      choices.push_back(degrees);
      for (std::size_t i = 1; i < correlations_.size(); ++i)
        choices.push_back(evidence(degrees.degrees, i));
    }
    return draw_choice(choices, random);
  }

 private:
  TailChoice evidence(double degrees, std::size_t correlation) {
    draw_.parameters.degrees = degrees;
    draw_.parameters.correlation = correlations_[correlation];
    return {degrees, correlation, run_through(of_, rows_, draw_)};
  }

  const TrainingRows& of_;
  const std::vector<Row>& rows_;
  BaselineDraw draw_;
  const std::vector<MatrixXd>& correlations_;
  std::vector<TailChoice> degrees_;
  std::map<double, std::vector<TailChoice>> choices_;
};

std::vector<Row> rows_of(const Series& series, const Baseline& baseline) {
  std::vector<Row> rows;
  for (int t = 0; t < series.rows(); ++t) rows.push_back(row_of(series, t, baseline.usual_sds));
  return rows;
}

/// Draw m of `count` draws that are spaced evenly over all chains.
std::span<const double> spaced_draw(const inference::Posterior& posterior, int m, int count) {
  std::size_t all = 0;
  for (const auto& chain : posterior.chains) all += chain.size();
  std::size_t at = (2 * index(m) + 1) * all / (2 * index(count));
  for (const auto& chain : posterior.chains) {
    if (at < chain.size()) return chain.draw(at, *posterior.space).theta;
    at -= chain.size();
  }
  throw std::logic_error("the posterior has no draws");
}

/// The draw with the highest posterior density.
std::span<const double> best_draw(const inference::Posterior& posterior) {
  std::span<const double> best;
  double top = -kInfinity;
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.size(); ++i)
      if (const auto draw = chain.draw(i, *posterior.space);
          best.empty() || draw.log_posterior() > top) {
        top = draw.log_posterior();
        best = draw.theta;
      }
  return best;
}

/// The largest split R-hat over the features of: the covariates' effect in some learning rows, the
/// noise, and the drift. Knots need no R-hat near one: different covariates that move together
/// explain the same effect.
double rhat_of_effects(const TrainingRows& of, const Layout& layout,
                       const inference::Posterior& posterior) {
  constexpr std::size_t kMostDraws = 125;  // per chain
  constexpr Index kRows = 4;
  const std::size_t each = kRows + 2, count = of.features.size() * each + 1;
  std::vector<inference::ChainsOf> quantities(count, inference::ChainsOf(posterior.chains.size()));
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    const auto& chain = posterior.chains[c];
    const std::size_t n = std::min(chain.size(), kMostDraws);
    for (std::size_t i = 0; i < n; ++i) {
      const auto x = chain.draw(i * chain.size() / n, *posterior.space).theta;
      CovariateTerms terms = terms_of(of, layout, x);
      const MatrixXd table = term_table(of, terms);
      const std::vector<MarginalLikelihood> fits = fits_of(of, layout, table, x);
      for (std::size_t j = 0; j < of.features.size(); ++j) {
        const ProcessRatios process = ratios_of(layout, x, j);
        const MarginalLikelihood& fit = fits[j];
        for (Index r = 0; r < kRows; ++r)
          quantities[j * each + index(r)][c].push_back(
              fit.coefficients.dot(table.col((2 * r + 1) * table.cols() / (2 * kRows))));
        quantities[j * each + kRows][c].push_back(std::log(fit.scale / fit.shape));
        quantities[j * each + kRows + 1][c].push_back(std::log(process.fast_ratio));
      }
      quantities.back()[c].push_back(std::log(x[layout.rate()]));
    }
  }
  double most = 1.0;
  for (const auto& one : quantities) most = std::max(most, inference::rhat(one));
  return most;
}

void tell_of_engine(const inference::Posterior& posterior, Baseline& out) {
  out.likelihood_evaluations = posterior.likelihood_evaluations;
  out.hinge_probability.assign(static_cast<std::size_t>(posterior.space->size()), 0.0);
  double all = 0.0;
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.size(); ++i, all += 1.0)
      out.hinge_probability[index(chain.model[i])] += 1.0;
  for (double& p : out.hinge_probability) p /= all;
}

void check_faults(const Series& learning) {
  for (const SeriesFault& fault : find_faults(learning, learning.rows()))
    if (fault.kind != SeriesFault::Kind::covariate_constant)
      throw std::invalid_argument("the training rows have a fault: see find_faults");
}

void set_times(const Series& learning, Baseline& out) {
  out.last_hours = learning.hours.back();
  out.rows_per_hour = 1.0 / median_step(learning.hours);
}

/// A parameter of x for a climb: a logarithm between bounds, or a hinge's quantile.
struct Range {
  double low, high;
  bool is_log;
};

std::vector<Range> ranges_of(const Layout& layout, std::span<const double> x) {
  std::vector<Range> out;
  if (layout.lag) out.push_back({kShortestLag, kLongestLag, true});
  out.push_back({kShortestDrift, kLongestDrift, true});
  out.push_back({kLeastSlow, kMostSlow, true});
  for (std::size_t j = 0; j < layout.features; ++j) out.push_back({kLeastFast, kMostFast, true});
  for (std::size_t i = layout.hinge(0); i < x.size(); ++i)
    out.push_back({std::floor(x[i]), std::floor(x[i]) + 1.0 - 1e-9, false});
  return out;
}

/// The best draw of another training period, for the covariates that vary in this one.
std::vector<double> start_of_climb(const TrainingRows& of, const Layout& layout,
                                   const Baseline& from, const Baseline& here) {
  const Layout before{.lag = from.has_lag, .features = layout.features};
  std::vector<double> x;
  if (layout.lag) x.push_back(before.lag ? from.best[0] : 1.0);
  x.insert(x.end(), from.best.begin() + static_cast<std::ptrdiff_t>(before.rate()),
           from.best.begin() + static_cast<std::ptrdiff_t>(before.hinge(0)));
  for (std::size_t i = before.hinge(0); i < from.best.size(); ++i) {
    const double place =
        std::floor(std::min(from.best[i], static_cast<double>(from.hinged.size()) - 1e-9));
    const int covariate = from.hinged[static_cast<std::size_t>(place)];
    for (std::size_t k = 0; k < of.hinged.size(); ++k)
      if (here.scaling.used()[index(of.hinged[k])] == covariate)
        x.push_back(static_cast<double>(k) + (from.best[i] - place));
  }
  return x;
}

/// Maximises the evidence about x by steps along one parameter after the other.
std::vector<double> climb(const TrainingRows& of, const Layout& layout, std::vector<double> x) {
  constexpr int kSweeps = 12;
  constexpr double kFirst = 0.08, kLast = 0.005;  // steps, in shares of a parameter's range
  const std::vector<Range> ranges = ranges_of(layout, x);
  std::vector<double> steps(x.size(), kFirst);
  double best = log_evidence(of, layout, x);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::abs(steps[i]) < kLast) continue;
      const Range& range = ranges[i];
      bool better = false;
      for (int side = 0; side < 2 && !better; ++side) {
        std::vector<double> other = x;
        other[i] = range.is_log ? x[i] * std::exp(steps[i] * std::log(range.high / range.low))
                                : x[i] + steps[i] * (range.high - range.low);
        other[i] = std::clamp(other[i], range.low, range.high);
        const double value = other[i] == x[i] ? -kInfinity : log_evidence(of, layout, other);
        better = value > best;
        if (better) {
          best = value;
          x = std::move(other);
        } else {
          steps[i] = -steps[i];
        }
      }
      steps[i] *= better ? 1.5 : 0.4;
    }
    if (std::ranges::all_of(steps, [](double step) { return std::abs(step) < kLast; })) break;
  }
  return x;
}

}  // namespace

Weather next_weather(const CovariateScaling::Scaled& scaled, double hours, BaselineDraw& draw) {
  follow_lag(scaled.z, hours, draw.parameters.terms.lag_hours, draw.lagged);
  follow_lag(scaled.z, hours, kLongLagHours, draw.slow);
  follow_lag(scaled.variance.diagonal().cwiseMax(0.0).cwiseSqrt(), hours,
             draw.parameters.terms.lag_hours, draw.lagged_error);
  return weather_at(draw.parameters.terms, scaled, draw.lagged, draw.slow);
}

bool is_weather_known(const BaselineDraw& draw, const VectorXd& residual_sd) {
  if (draw.lagged_error.size() == 0 || draw.lagged_error.maxCoeff() == 0.0) return true;
  const CovariateTerms& terms = draw.parameters.terms;
  for (Index j = 0; j < residual_sd.size(); ++j) {
    const auto b = draw.filter.x.segment(j * draw.parameters.block(), draw.parameters.block() - 2);
    // Both slopes of a hinge: the missing covariate may be on either side.
    VectorXd slopes = b.segment(1, draw.lagged_error.size());
    VectorXd beyond = slopes;
    for (std::size_t h = 0; h < terms.knots.size(); ++h)
      beyond[terms.hinge_of[h]] += b[1 + slopes.size() + static_cast<Index>(h)];
    const VectorXd steepest = slopes.cwiseAbs().cwiseMax(beyond.cwiseAbs());
    if (steepest.cwiseProduct(draw.lagged_error).norm() > kLargestWeatherError * residual_sd[j])
      return false;
  }
  return true;
}

namespace {
int usual_draws(long entries, int coefficients) {
  constexpr long kFewEntries = 1000;
  const int usual = coefficients > 80 ? 4 : 6;
  // Few entries leave the parameters uncertain.
  return entries <= kFewEntries ? std::clamp(1000 / coefficients, usual, 24) : usual;
}
}  // namespace

Baseline learn_baseline(const Series& learning, const LearningOptions& options) {
  check_faults(learning);
  Baseline out{.scaling = CovariateScaling(learning.covariates),
               .usual_sds = usual_sds(learning, learning.rows())};
  const std::shared_ptr<const TrainingRows> prepared = prepare(learning, options, out);
  const Layout layout{.lag = prepared->lag,
                      .features = prepared->features.size(),
                      .slow_hours = prepared->slow_hours};
  const inference::Problem problem{.space = space_of(*prepared), .likelihood = [prepared, layout] {
                                     return std::make_unique<LearningLikelihood>(*prepared, layout);
                                   }};
  // The evidences are not used. Where a likelihood evaluation is fast, the longer exploration that
  // they need improves the proposals for many covariates.
  const long entries = static_cast<long>(learning.rows()) * learning.feature_count();
  inference::Options engine{.seed = options.seed,
                            .chains = options.chains,
                            .threads = options.threads,
                            .warmup = options.engine_warmup,
                            .draws = options.engine_draws,
                            .thin = 4,
                            .searches = options.searches,
                            .evidences = entries <= kManyEntries};
  if (options.progress)
    engine.progress = [&](const inference::Options::Progress& p) {
      return options.progress(p.fraction);
    };
  const inference::Posterior posterior = inference::reversible_jump(problem, engine);
  tell_of_engine(posterior, out);
  const std::span<const double> best = best_draw(posterior);
  out.best.assign(best.begin(), best.end());
  out.has_lag = layout.lag;
  for (const int c : prepared->hinged) out.hinged.push_back(out.scaling.used()[index(c)]);
  out.rhat_max = rhat_of_effects(*prepared, layout, posterior);
  out.converged = out.rhat_max < kLargestRhat;

  const std::vector<Row> rows = rows_of(learning, out);
  base::Random random(options.seed, 0, 0, base::Purpose::simulation);
  BaselineDraw central{.parameters = parameters_of(*prepared, layout, best, out.reference, random)};
  CovariateTerms terms = terms_of(*prepared, layout, best);
  const std::vector<MatrixXd> correlations = possible_correlations(
      drift_correlation(*prepared, term_table(*prepared, terms), layout, best));
  TailChoices choices(*prepared, rows, central, correlations);
  const auto p = static_cast<Index>(prepared->features.size());
  VectorXd variance = VectorXd::Zero(p);
  const int unseen = out.scaling.count() > 0 ? kUnseenTerms : 0;
  const int coefficients =
      static_cast<int>((central.parameters.coefficient_sd.rows() - unseen) * p);
  const int draws = options.draws > 0
                        ? options.draws
                        : usual_draws(learning.features.array().isFinite().count(), coefficients);
  for (int m = 0; m < draws; ++m) {
    BaselineDraw draw{.parameters =
                          parameters_of(*prepared, layout, spaced_draw(posterior, m, draws),
                                        out.reference, random)};
    const TailChoice choice = choices.draw(random);
    draw.parameters.degrees = choice.degrees;
    draw.parameters.correlation = correlations[choice.correlation];
    run_through(*prepared, rows, draw);
    variance.array() +=
        draw.parameters.noise_sd.array().square() + draw.parameters.fast_sd.array().square();
    out.draws.push_back(std::move(draw));
  }
  out.residual_sd = (variance / draws).cwiseSqrt();
  set_times(learning, out);
  return out;
}

Baseline refit_baseline(const Series& learning, const Baseline& from,
                        const LearningOptions& options) {
  check_faults(learning);
  Baseline out{.scaling = CovariateScaling(learning.covariates),
               .usual_sds = usual_sds(learning, learning.rows())};
  const std::unique_ptr<TrainingRows> prepared = prepare(learning, options, out);
  const Layout layout{.lag = prepared->lag,
                      .features = prepared->features.size(),
                      .slow_hours = prepared->slow_hours};
  const std::vector<double> x =
      climb(*prepared, layout, start_of_climb(*prepared, layout, from, out));
  base::Random random(options.seed, 1, 0, base::Purpose::simulation);
  BaselineDraw draw{.parameters = parameters_of(*prepared, layout, x, out.reference, random)};
  draw.parameters.degrees = from.draws.front().parameters.degrees;
  draw.parameters.correlation = from.draws.front().parameters.correlation;
  run_through(*prepared, rows_of(learning, out), draw);
  out.residual_sd =
      (draw.parameters.noise_sd.array().square() + draw.parameters.fast_sd.array().square()).sqrt();
  out.draws.push_back(std::move(draw));
  set_times(learning, out);
  return out;
}

}  // namespace wheeltap::identification::monitoring
