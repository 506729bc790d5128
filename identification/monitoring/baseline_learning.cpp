#include "identification/monitoring/baseline_learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/random.hpp"
#include "identification/monitoring/marginal_likelihood.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRobustDegrees = 5.0;
constexpr double kInterceptScale = 100.0, kSlopeScale = 10.0;  // × noise sd
// Prior sd of slopes below and above the weather of training, relative to the covariates' effect
// there. Frost stiffens concrete and asphalt far more than an equal step in mild weather.
constexpr double kBelow = 6.0, kAbove = 2.0;
constexpr double kLeastSlow = 0.5;  // least slow ratio: a short training cannot exclude slow drift
constexpr double kShortestLag = 0.1, kLongestLag = 72.0;

/// Training rows, prepared for the engine.
struct Prepared {
  std::vector<double> hours = {};
  std::vector<CovariateScaling::Scaled> scaled = {};
  std::vector<FeatureRows> features = {};
  VectorXd long_low = {}, long_high = {};  ///< range of covariates with the long lag
  MatrixXd sorted = {};                    ///< rows x covariates, each column sorted for quantiles
  std::vector<int> hinged = {};            ///< covariates that may have hinges
  std::vector<double> variance = {};       ///< per feature
  bool lag = false;
  int most_hinges = 0;
};

VectorXd coefficient_scales(Index terms) {
  VectorXd g = VectorXd::Constant(terms, kSlopeScale);
  g[0] = kInterceptScale;
  return g;
}

RegressionPrior prior_of(const Prepared& of, std::size_t feature, Index terms) {
  return {.coefficient_scale = coefficient_scales(terms),
          .shape = 1.0,
          .scale = 0.1 * of.variance[feature]};
}

/// Positions in the parameter vector: lag (if any), time constant, slow ratio, fast ratio of each
/// feature, one number per hinge (index of its covariate plus quantile of its knot).
struct Layout {
  bool lag;
  std::size_t features;
  [[nodiscard]] std::size_t rate() const { return lag ? 1 : 0; }
  [[nodiscard]] std::size_t slow() const { return rate() + 1; }
  [[nodiscard]] std::size_t fast(std::size_t j) const { return slow() + 1 + j; }
  [[nodiscard]] std::size_t hinge(std::size_t h) const { return slow() + 1 + features + h; }
};

CovariateTerms terms_of(const Prepared& of, const Layout& layout, std::span<const double> x) {
  CovariateTerms out;
  if (layout.lag) out.lag_hours = x[0];
  for (std::size_t i = layout.hinge(0); i < x.size(); ++i) {
    const auto place = std::min(static_cast<std::size_t>(x[i]), of.hinged.size() - 1);
    const double quantile = 0.02 + 0.96 * std::clamp(x[i] - static_cast<double>(place), 0.0, 1.0);
    const int covariate = of.hinged[place];
    const double at = quantile * static_cast<double>(of.sorted.rows() - 1);
    const auto low = static_cast<Index>(at);
    const Index high = std::min(low + 1, of.sorted.rows() - 1);
    const double share = at - static_cast<double>(low);
    out.hinge_of.push_back(covariate);
    out.knots.push_back((1.0 - share) * of.sorted(low, covariate) +
                        share * of.sorted(high, covariate));
  }
  return out;
}

/// phi of all rows, one column per row, without the terms of extrapolation. Also sets the range of
/// the lagged covariates.
MatrixXd term_table(const Prepared& of, CovariateTerms& terms) {
  const Index c = of.sorted.cols(), hinges = static_cast<Index>(terms.knots.size());
  const auto n = static_cast<Index>(of.hours.size());
  MatrixXd out(1 + c + hinges, n);
  double before = -1.0, follows = 1.0;  // fraction of z - v that a step adds to v
  for (Index t = 0; t < n; ++t) {
    const double step = t > 0 ? of.hours[index(t)] - of.hours[index(t - 1)] : 0.0;
    if (terms.lag_hours > 0.0 && step != before) follows = -std::expm1(-step / terms.lag_hours);
    before = step;
    const double* z = of.scaled[index(t)].z.data();
    double* phi = out.col(t).data();
    phi[0] = 1.0;
    if (t == 0 || !(terms.lag_hours > 0.0)) {
      std::copy(z, z + c, phi + 1);
    } else {
      const double* last = out.col(t - 1).data() + 1;
      for (Index i = 0; i < c; ++i) phi[1 + i] = last[i] + follows * (z[i] - last[i]);
    }
    for (Index h = 0; h < hinges; ++h)
      phi[1 + c + h] = std::max(0.0, phi[1 + terms.hinge_of[index(h)]] - terms.knots[index(h)]);
  }
  terms.long_low = of.long_low;
  terms.long_high = of.long_high;
  terms.low = out.middleRows(1, c).rowwise().minCoeff();
  terms.high = out.middleRows(1, c).rowwise().maxCoeff();
  return out;
}

ProcessRatios ratios_of(const Layout& layout, std::span<const double> x, std::size_t feature) {
  return {.fast_rate = 1.0 / x[layout.rate()],
          .fast_ratio = x[layout.fast(feature)],
          .slow_ratio = x[layout.slow()]};
}

class LearningLikelihood final : public inference::Likelihood {
 public:
  LearningLikelihood(const Prepared& of, Layout layout) : of_(of), layout_(layout) {}
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    CovariateTerms terms = terms_of(of_, layout_, x);
    const MatrixXd table = term_table(of_, terms);
    double sum = 0.0;
    for (std::size_t j = 0; j < of_.features.size(); ++j)
      sum += marginal_likelihood(of_.hours, table, of_.features[j], ratios_of(layout_, x, j),
                                 prior_of(of_, j, table.rows()))
                 .log_density;
    return sum;
  }

 private:
  const Prepared& of_;
  Layout layout_;
};

/// Down-weights outliers in three iterations. Residuals are about a fit with hinges at all medians.
void weigh_outliers(Prepared& of) {
  CovariateTerms terms;
  for (const int c : of.hinged) {
    terms.hinge_of.push_back(c);
    terms.knots.push_back(of.sorted(of.sorted.rows() / 2, c));
  }
  const MatrixXd table = term_table(of, terms);
  const ProcessRatios process{.fast_rate = 1.0 / 24.0, .fast_ratio = 0.3, .slow_ratio = 0.1};
  for (std::size_t j = 0; j < of.features.size(); ++j) {
    FeatureRows& feature = of.features[j];
    const VectorXd stated = feature.precision;
    for (int pass = 0; pass < 3; ++pass) {
      const MarginalLikelihood fit =
          marginal_likelihood(of.hours, table, feature, process, prior_of(of, j, table.rows()));
      VectorXd r = whitened_residuals(of.hours, table, feature, process, fit.coefficients);
      VectorXd sizes = r.cwiseAbs();
      const auto middle = sizes.data() + sizes.size() / 2;
      std::nth_element(sizes.data(), middle, sizes.data() + sizes.size());
      r /= std::max(1.4826 * *middle, 1e-300);
      for (Index t = 0; t < r.size(); ++t)
        feature.precision[t] = stated[t] * (kRobustDegrees + 1.0) / (kRobustDegrees + r[t] * r[t]);
    }
  }
}

Prepared prepare(const Series& series, const LearningOptions& options, Baseline& out) {
  Prepared of{.hours = series.hours};
  const auto n = static_cast<Index>(series.rows());
  of.sorted.resize(n, out.scaling.count());
  VectorXd slow;
  for (Index t = 0; t < n; ++t) {
    of.scaled.push_back(out.scaling(series.covariates.row(t).transpose()));
    of.sorted.row(t) = of.scaled.back().z.transpose();
    follow_lag(of.scaled.back().z, t > 0 ? of.hours[index(t)] - of.hours[index(t - 1)] : 0.0,
               kLongLagHours, slow);
    of.long_low = t > 0 ? of.long_low.cwiseMin(slow).eval() : slow;
    of.long_high = t > 0 ? of.long_high.cwiseMax(slow).eval() : slow;
  }
  for (auto column : of.sorted.colwise()) std::sort(column.data(), column.data() + column.size());
  for (int c = 0; c < out.scaling.count(); ++c)
    if (options.hinges &&
        (options.may_hinge.empty() || options.may_hinge[index(out.scaling.used()[index(c)])]))
      of.hinged.push_back(c);
  of.most_hinges = of.hinged.empty() ? 0 : options.most_hinges;
  of.lag = options.lag && out.scaling.count() > 0;
  out.reference.resize(series.feature_count());
  for (int j = 0; j < series.feature_count(); ++j) {
    FeatureRows rows;
    std::vector<double> values, precisions;
    for (int t = 0; t < series.rows(); ++t) {
      const Row row = row_of(series, t, out.usual_sds);
      if (!std::isfinite(row.features[j])) continue;
      rows.rows.push_back(t);
      values.push_back(row.features[j]);
      precisions.push_back(1.0 / row.relative_variance[j]);
    }
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    out.reference[j] = sorted[sorted.size() / 2];
    const auto count = static_cast<Index>(values.size());
    rows.y = Eigen::Map<const VectorXd>(values.data(), count).array() - out.reference[j];
    rows.precision = Eigen::Map<const VectorXd>(precisions.data(), count);
    of.variance.push_back(std::max(rows.y.squaredNorm() / static_cast<double>(count), 1e-24));
    of.features.push_back(std::move(rows));
  }
  return of;
}

inference::ModelSpace space_of(const Prepared& of) {
  using inference::LogUniform;
  std::vector<inference::Parameter> common;
  if (of.lag) common.push_back({"lag", LogUniform{.lower = kShortestLag, .upper = kLongestLag}});
  common.push_back({"time constant", LogUniform{.lower = 0.5, .upper = 30.0 * 24.0}});
  common.push_back({"slow ratio", LogUniform{.lower = kLeastSlow, .upper = 10.0}});
  for (std::size_t j = 0; j < of.features.size(); ++j)
    common.push_back(
        {"fast ratio " + std::to_string(j + 1), LogUniform{.lower = 1e-3, .upper = 1e2}});
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

/// Correlation matrix of the drift, estimated from the correlation of the residuals.
MatrixXd drift_correlation(const Prepared& of, const MatrixXd& table, const Layout& layout,
                           std::span<const double> x) {
  const std::size_t p = of.features.size();
  const auto n = static_cast<Index>(of.hours.size());
  const auto m = static_cast<Index>(p);
  MatrixXd residuals = MatrixXd::Constant(n, m, kNaN);
  VectorXd share(m);
  for (std::size_t j = 0; j < p; ++j) {
    const ProcessRatios process = ratios_of(layout, x, j);
    const auto fit = marginal_likelihood(of.hours, table, of.features[j], process,
                                         prior_of(of, j, table.rows()));
    const VectorXd r =
        whitened_residuals(of.hours, table, of.features[j], process, fit.coefficients);
    const double sd = std::sqrt(fit.scale / fit.shape);
    for (Index t = 0; t < r.size(); ++t)
      residuals(of.features[j].rows[index(t)], static_cast<Index>(j)) =
          std::clamp(r[t] / sd, -3.0, 3.0);
    share[static_cast<Index>(j)] = process.fast_ratio / (1.0 + process.fast_ratio);
  }
  MatrixXd c = MatrixXd::Identity(m, m);
  for (Index a = 0; a < m; ++a)
    for (Index b = 0; b < a; ++b) {
      double aa = 0.0, bb = 0.0, ab = 0.0;
      for (Index t = 0; t < n; ++t) {
        const double ra = residuals(t, a), rb = residuals(t, b);
        if (!std::isfinite(ra) || !std::isfinite(rb)) continue;
        aa += ra * ra;
        bb += rb * rb;
        ab += ra * rb;
      }
      const double r = aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
      c(a, b) = c(b, a) =
          std::clamp(r / std::max(0.2, std::sqrt(share[a] * share[b])), -0.95, 0.95);
    }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(c);
  c = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.02).asDiagonal() *
      eigen.eigenvectors().transpose();
  const VectorXd scale = c.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * c * scale.asDiagonal();
}

/// Parameters of one draw; noise variances are drawn from their inverse gamma posteriors.
BaselineParameters parameters_of(const Prepared& of, const Layout& layout,
                                 std::span<const double> x, const VectorXd& reference,
                                 base::Random& random) {
  BaselineParameters out{.terms = terms_of(of, layout, x)};
  const MatrixXd table = term_table(of, out.terms);
  const Index k = out.terms.size(static_cast<int>(of.sorted.cols()));
  const auto p = static_cast<Index>(of.features.size());
  out.fast_rate = 1.0 / x[layout.rate()];
  out.fast_sd.resize(p);
  out.slow_sd.resize(p);
  out.noise_sd.resize(p);
  out.correlation = MatrixXd::Identity(p, p);
  out.coefficient_mean = MatrixXd::Zero(k, p);
  out.coefficient_sd.resize(k, p);
  for (Index j = 0; j < p; ++j) {
    const std::size_t feature = index(j);
    const ProcessRatios process = ratios_of(layout, x, feature);
    const auto fit = marginal_likelihood(of.hours, table, of.features[feature], process,
                                         prior_of(of, feature, table.rows()));
    const double sd = std::sqrt(fit.scale / random.gamma(fit.shape));
    out.noise_sd[j] = sd;
    out.fast_sd[j] = sd * std::sqrt(process.fast_ratio);
    out.slow_sd[j] = sd * std::sqrt(process.slow_ratio);
    out.coefficient_mean(0, j) = reference[j];
    out.coefficient_sd.col(j) = sd * coefficient_scales(k);
    if (of.sorted.cols() > 0) {
      // The prior sd of slopes beyond the training weather, per standard deviation of a covariate,
      // is a multiple of the covariates' effect in training.
      const Index slopes = table.rows() - 1;
      VectorXd explained = table.bottomRows(slopes).transpose() * fit.coefficients.tail(slopes);
      explained.array() -= explained.mean();
      const double size =
          std::sqrt(explained.squaredNorm() / static_cast<double>(explained.size()));
      out.coefficient_sd.col(j).tail<kUnseenTerms>() =
          std::max(size, sd) * Eigen::Vector4d(kBelow, kAbove, kBelow, kAbove);
    }
  }
  return out;
}

/// Runs the full filter from its prior through the training rows; returns the log evidence.
double run_through(const Prepared& of, const std::vector<Row>& rows, BaselineDraw& draw) {
  draw.filter = BaselineFilter(draw.parameters);
  draw.lagged.resize(0);
  draw.slow.resize(0);
  double sum = 0.0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const double step = t > 0 ? rows[t].hours - rows[t - 1].hours : 0.0;
    const Weather weather = next_weather(of.scaled[t], step, draw);
    sum += filter_row(draw.parameters, weather, rows[t], step, draw.filter).log_density;
  }
  return sum;
}

struct TailChoice {
  double degrees, share, log_evidence;
};

/// Evidence of the full filter on a grid of degrees of freedom and of factors on the correlation.
std::vector<TailChoice> tail_choices(const Prepared& of, const std::vector<Row>& rows,
                                     BaselineDraw draw, const MatrixXd& correlation) {
  std::vector<TailChoice> out;
  const auto p = static_cast<Index>(of.features.size());
  for (const double share : {0.0, 0.5, 1.0}) {
    if (p == 1 && share > 0.0) break;
    draw.parameters.correlation = share * correlation + (1.0 - share) * MatrixXd::Identity(p, p);
    for (const double degrees : {3.0, 5.0, 8.0, 15.0, 40.0, kGaussian}) {
      draw.parameters.degrees = degrees;
      out.push_back({degrees, share, run_through(of, rows, draw)});
    }
  }
  return out;
}

const TailChoice& draw_choice(const std::vector<TailChoice>& choices, base::Random& random) {
  double top = -kInfinity, sum = 0.0;
  for (const TailChoice& c : choices) top = std::max(top, c.log_evidence);
  for (const TailChoice& c : choices) sum += std::exp(c.log_evidence - top);
  double left = random.uniform() * sum;
  for (const TailChoice& c : choices)
    if ((left -= std::exp(c.log_evidence - top)) <= 0.0) return c;
  return choices.back();
}

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
  throw std::logic_error("a posterior without draws");
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

/// The largest split R-hat, over all features, of the covariates' effect in some training rows, of
/// the noise and of the drift. Knots need no R-hat near 1, because different correlated covariates
/// can explain the same effect.
double rhat_of_effects(const Prepared& of, const Layout& layout,
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
      for (std::size_t j = 0; j < of.features.size(); ++j) {
        const ProcessRatios process = ratios_of(layout, x, j);
        const auto fit = marginal_likelihood(of.hours, table, of.features[j], process,
                                             prior_of(of, j, table.rows()));
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
  const inference::Verdict verdict = inference::judge(posterior);
  out.converged = verdict.converged;
  out.likelihood_evaluations = posterior.likelihood_evaluations;
  out.hinge_probability.assign(static_cast<std::size_t>(posterior.space->size()), 0.0);
  double all = 0.0;
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.size(); ++i, all += 1.0)
      out.hinge_probability[index(chain.model[i])] += 1.0;
  for (double& p : out.hinge_probability) p /= all;
}

}  // namespace

Weather next_weather(const CovariateScaling::Scaled& scaled, double hours, BaselineDraw& draw) {
  follow_lag(scaled.z, hours, draw.parameters.terms.lag_hours, draw.lagged);
  follow_lag(scaled.z, hours, kLongLagHours, draw.slow);
  return weather_at(draw.parameters.terms, scaled, draw.lagged, draw.slow);
}

Baseline learn_baseline(const Series& learning, const LearningOptions& options) {
  for (const SeriesFault& fault : find_faults(learning, learning.rows()))
    if (fault.kind != SeriesFault::Kind::covariate_constant)
      throw std::invalid_argument("the training rows have a fault: see find_faults");
  Baseline out{.scaling = CovariateScaling(learning.covariates),
               .usual_sds = usual_sds(learning, learning.rows())};
  const auto prepared = std::make_shared<Prepared>(prepare(learning, options, out));
  weigh_outliers(*prepared);
  const Layout layout{.lag = prepared->lag, .features = prepared->features.size()};
  const inference::Problem problem{.space = space_of(*prepared), .likelihood = [prepared, layout] {
                                     return std::make_unique<LearningLikelihood>(*prepared, layout);
                                   }};
  inference::Options engine{.seed = options.seed,
                            .chains = options.chains,
                            .threads = options.threads,
                            .warmup = options.engine_warmup,
                            .draws = options.engine_draws,
                            .thin = 4,
                            .searches = options.searches};
  if (options.progress)
    engine.progress = [&](const inference::Options::Progress& p) {
      return options.progress(p.fraction);
    };
  const inference::Posterior posterior = inference::reversible_jump(problem, engine);
  tell_of_engine(posterior, out);
  out.rhat_max = rhat_of_effects(*prepared, layout, posterior);

  const std::vector<Row> rows = rows_of(learning, out);
  base::Random random(options.seed, 0, 0, base::Purpose::simulation);
  const std::span<const double> best = best_draw(posterior);
  BaselineDraw central{.parameters = parameters_of(*prepared, layout, best, out.reference, random)};
  CovariateTerms terms = terms_of(*prepared, layout, best);
  const MatrixXd correlation =
      drift_correlation(*prepared, term_table(*prepared, terms), layout, best);
  const std::vector<TailChoice> choices = tail_choices(*prepared, rows, central, correlation);
  const auto p = static_cast<Index>(prepared->features.size());
  VectorXd variance = VectorXd::Zero(p);
  const auto coefficients = static_cast<int>(central.parameters.coefficient_sd.size());
  const int draws = options.draws > 0 ? options.draws : coefficients > 80 ? 4 : 6;
  for (int m = 0; m < draws; ++m) {
    BaselineDraw draw{.parameters =
                          parameters_of(*prepared, layout, spaced_draw(posterior, m, draws),
                                        out.reference, random)};
    const TailChoice& choice = draw_choice(choices, random);
    draw.parameters.degrees = choice.degrees;
    draw.parameters.correlation =
        choice.share * correlation + (1.0 - choice.share) * MatrixXd::Identity(p, p);
    run_through(*prepared, rows, draw);
    variance.array() +=
        draw.parameters.noise_sd.array().square() + draw.parameters.fast_sd.array().square();
    out.draws.push_back(std::move(draw));
  }
  out.residual_sd = (variance / draws).cwiseSqrt();
  out.last_hours = learning.hours.back();
  out.rows_per_hour =
      static_cast<double>(learning.rows() - 1) / (learning.hours.back() - learning.hours.front());
  return out;
}

}  // namespace wheeltap::identification::monitoring
