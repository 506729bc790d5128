#include "identification/monitoring/baseline_training.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::monitoring::training {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kRobustDegrees = 5.0;
constexpr double kInterceptScale = 100.0;  // of coefficients, in noise sds
constexpr double kLeastSlopeScale = 10.0, kSlopesOfSd = 3.0;
constexpr double kNoiseOfVariance = 0.1;
// Prior sd of slopes beyond learning's weather, below and above, in what covariates explained in
// it. Frost stiffens concrete and asphalt many times more than the same step in mild weather.
constexpr double kLeastCorrelation = 0.02;  // of innovations of a common drift
constexpr double kBelow = 6.0, kAbove = 2.0;

VectorXd coefficient_scales(Index terms, double slopes) {
  VectorXd g = VectorXd::Constant(terms, slopes);
  g[0] = kInterceptScale;
  return g;
}

RegressionPrior prior_of(const TrainingRows& of, std::size_t feature, Index terms) {
  return {.coefficient_scale = coefficient_scales(terms, of.slope_scale[feature]),
          .shape = 1.0,
          .scale = of.noise_scale[feature]};
}

}  // namespace

CovariateTerms terms_of(const TrainingRows& of, const Layout& layout, std::span<const double> x) {
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

namespace {

/// phi of all rows.
MatrixXd table_of(const TrainingRows& of, const CovariateTerms& terms) {
  const Index c = of.sorted.cols(), hinges = static_cast<Index>(terms.knots.size());
  const auto n = static_cast<Index>(of.hours.size());
  MatrixXd out(1 + c + hinges, n);
  double before = -1.0, follows = 1.0;  // share of the way that v goes in a step
  for (Index t = 0; t < n; ++t) {
    const double step = t > 0 ? of.hours[index(t)] - of.hours[index(t - 1)] : 0.0;
    if (terms.lag_hours > 0.0 && step != before) follows = -std::expm1(-step / terms.lag_hours);
    before = step;
    const double* z = of.z.col(t).data();
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
  return out;
}

}  // namespace

MatrixXd term_table(const TrainingRows& of, CovariateTerms& terms) {
  const Index c = of.sorted.cols();
  MatrixXd out = table_of(of, terms);
  terms.long_low = of.long_low;
  terms.long_high = of.long_high;
  terms.low = out.middleRows(1, c).rowwise().minCoeff();
  terms.high = out.middleRows(1, c).rowwise().maxCoeff();
  return out;
}

ProcessRatios ratios_of(const Layout& layout, std::span<const double> x, std::size_t feature) {
  return {.fast_rate = 1.0 / x[layout.rate()],
          .fast_ratio = x[layout.fast(feature)],
          .slow_ratio = x[layout.slow()],
          .slow_hours = layout.slow_hours};
}

std::vector<MarginalLikelihood> fits_of(const TrainingRows& of, const Layout& layout,
                                        const MatrixXd& table, std::span<const double> x) {
  std::vector<RegressionPrior> priors;
  for (std::size_t j = 0; j < of.features.size(); ++j)
    priors.push_back(prior_of(of, j, table.rows()));
  return (*of.evidence)(table, 1.0 / x[layout.rate()], x[layout.slow()],
                        x.subspan(layout.fast(0), layout.features), priors);
}

double log_evidence(const TrainingRows& of, const Layout& layout, std::span<const double> x) {
  const MatrixXd table = table_of(of, terms_of(of, layout, x));
  double sum = 0.0;
  for (const MarginalLikelihood& one : fits_of(of, layout, table, x)) sum += one.log_density;
  return sum;
}

namespace {

/// Weights that reduce outliers: of residuals about hinges at every median, three times.
void weigh_outliers(TrainingRows& of) {
  CovariateTerms terms;
  for (const int c : of.hinged) {
    terms.hinge_of.push_back(c);
    terms.knots.push_back(of.sorted(of.sorted.rows() / 2, c));
  }
  const MatrixXd table = term_table(of, terms);
  const ProcessRatios process{
      .fast_rate = 1.0 / 24.0, .fast_ratio = 0.3, .slow_ratio = 0.1, .slow_hours = of.slow_hours};
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
      const double sigma = std::max(1.4826 * *middle, 1e-4 * std::sqrt(of.variance[j]));
      r /= sigma;
      of.slope_scale[j] =
          std::max(kLeastSlopeScale, kSlopesOfSd * std::sqrt(of.variance[j]) / sigma);
      of.noise_scale[j] = std::min(kNoiseOfVariance * of.variance[j], sigma * sigma);
      for (Index t = 0; t < r.size(); ++t)
        feature.precision[t] = stated[t] * (kRobustDegrees + 1.0) / (kRobustDegrees + r[t] * r[t]);
    }
  }
}

}  // namespace

std::unique_ptr<TrainingRows> prepare(const Series& series, const LearningOptions& options,
                                      Baseline& out) {
  auto prepared = std::make_unique<TrainingRows>();
  TrainingRows& of = *prepared;
  of.hours = series.hours;
  // A drift that takes as long as the training period cannot be ruled out by it.
  of.slow_hours = std::min(kSlowHours, of.hours.back() - of.hours.front());
  const auto n = static_cast<Index>(series.rows());
  of.sorted.resize(n, out.scaling.count());
  of.z.resize(out.scaling.count(), n);
  VectorXd slow;
  for (Index t = 0; t < n; ++t) {
    of.scaled.push_back(out.scaling(series.covariates.row(t).transpose()));
    of.sorted.row(t) = of.scaled.back().z.transpose();
    of.z.col(t) = of.scaled.back().z;
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
  of.slope_scale.assign(of.features.size(), kLeastSlopeScale);
  for (const double variance : of.variance) of.noise_scale.push_back(kNoiseOfVariance * variance);
  weigh_outliers(of);
  of.evidence.emplace(of.hours, of.features, of.slow_hours);
  return prepared;
}

double innovation_correlation(const ProcessRatios& a, const ProcessRatios& b, double step) {
  using Eigen::Matrix2d;
  using Eigen::Vector2d;
  const double fast = std::exp(-a.fast_rate * step), slow = std::exp(-step / a.slow_hours);
  const Vector2d decay(fast, slow), h(1.0, 1.0);
  struct Filter {
    Matrix2d p;
    Vector2d stationary, gain;
    double s;
  };
  const auto start = [](const ProcessRatios& of) {
    const Vector2d stationary(of.fast_ratio, of.slow_ratio);
    return Filter{stationary.asDiagonal(), stationary, Vector2d::Zero(), 1.0};
  };
  Filter one = start(a), two = start(b);
  const auto advance = [&](Filter& f) {
    f.p = decay.asDiagonal() * f.p * decay.asDiagonal();
    f.p.diagonal().array() += (1.0 - decay.array().square()) * f.stationary.array();
    f.s = h.dot(f.p * h) + 1.0;
    f.gain = f.p * h / f.s;
    f.p -= f.s * f.gain * f.gain.transpose();
  };
  const double common = std::sqrt(a.fast_ratio * b.fast_ratio);
  Matrix2d cross = Matrix2d::Zero();
  cross(0, 0) = common;
  double out = 0.0;
  constexpr int kSteps = 4000;
  for (int t = 0; t < kSteps; ++t) {
    advance(one);
    advance(two);
    cross = (decay.asDiagonal() * cross * decay.asDiagonal()).eval();
    cross(0, 0) += (1.0 - fast * fast) * common;
    out = h.dot(cross * h) / std::sqrt(one.s * two.s);
    cross = ((Matrix2d::Identity() - one.gain * h.transpose()) * cross *
             (Matrix2d::Identity() - two.gain * h.transpose()).transpose())
                .eval();
  }
  return out;
}

MatrixXd drift_correlation(const TrainingRows& of, const MatrixXd& table, const Layout& layout,
                           std::span<const double> x) {
  const std::size_t p = of.features.size();
  const auto n = static_cast<Index>(of.hours.size());
  const auto m = static_cast<Index>(p);
  MatrixXd residuals = MatrixXd::Constant(n, m, kNaN);
  const std::vector<MarginalLikelihood> fits = fits_of(of, layout, table, x);
  for (std::size_t j = 0; j < p; ++j) {
    const ProcessRatios process = ratios_of(layout, x, j);
    const MarginalLikelihood& fit = fits[j];
    const VectorXd r =
        whitened_residuals(of.hours, table, of.features[j], process, fit.coefficients);
    const double sd = std::sqrt(fit.scale / fit.shape);
    for (Index t = 0; t < r.size(); ++t)
      residuals(of.features[j].rows[index(t)], static_cast<Index>(j)) =
          std::clamp(r[t] / sd, -3.0, 3.0);
  }
  const double step = median_step(of.hours);
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
      const double most = innovation_correlation(ratios_of(layout, x, index(a)),
                                                 ratios_of(layout, x, index(b)), step);
      c(a, b) = c(b, a) = std::clamp(r / std::max(kLeastCorrelation, most), -0.95, 0.95);
    }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(c);
  c = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.02).asDiagonal() *
      eigen.eigenvectors().transpose();
  const VectorXd scale = c.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * c * scale.asDiagonal();
}

BaselineParameters parameters_of(const TrainingRows& of, const Layout& layout,
                                 std::span<const double> x, const VectorXd& reference,
                                 base::Random& random) {
  BaselineParameters out{.terms = terms_of(of, layout, x)};
  const MatrixXd table = term_table(of, out.terms);
  const Index k = out.terms.size(static_cast<int>(of.sorted.cols()));
  const auto p = static_cast<Index>(of.features.size());
  out.fast_rate = 1.0 / x[layout.rate()];
  out.slow_hours = layout.slow_hours;
  out.fast_sd.resize(p);
  out.slow_sd.resize(p);
  out.noise_sd.resize(p);
  out.correlation = MatrixXd::Identity(p, p);
  out.coefficient_mean = MatrixXd::Zero(k, p);
  out.coefficient_sd.resize(k, p);
  const std::vector<MarginalLikelihood> fits = fits_of(of, layout, table, x);
  for (Index j = 0; j < p; ++j) {
    const std::size_t feature = index(j);
    const ProcessRatios process = ratios_of(layout, x, feature);
    const MarginalLikelihood& fit = fits[feature];
    const double sd = std::sqrt(fit.scale / random.gamma(fit.shape));
    out.noise_sd[j] = sd;
    out.fast_sd[j] = sd * std::sqrt(process.fast_ratio);
    out.slow_sd[j] = sd * std::sqrt(process.slow_ratio);
    out.coefficient_mean(0, j) = reference[j];
    out.coefficient_sd.col(j) = sd * coefficient_scales(k, of.slope_scale[feature]);
    if (of.sorted.cols() > 0) {
      // Beyond the learning period's weather a slope may be a few times what the covariates
      // explained in it, in standard deviations of a covariate.
      const Index slopes = table.rows() - 1;
      VectorXd explained = table.bottomRows(slopes).transpose() * fit.coefficients.tail(slopes);
      explained.array() -= explained.mean();
      const double size =
          std::sqrt(explained.squaredNorm() / static_cast<double>(explained.size()));
      for (int i = 0; i < kUnseenTerms; ++i)
        out.coefficient_sd(k - kUnseenTerms + i, j) =
            std::max(size, sd) * (i / kUnseenSegments % 2 == 0 ? kBelow : kAbove);
    }
  }
  return out;
}

double run_through(const TrainingRows& of, const std::vector<Row>& rows, BaselineDraw& draw) {
  draw.filter = BaselineFilter(draw.parameters);
  draw.lagged.resize(0);
  draw.lagged_error.resize(0);
  draw.slow.resize(0);
  double sum = 0.0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const double step = t > 0 ? rows[t].hours - rows[t - 1].hours : 0.0;
    const Weather weather = next_weather(of.scaled[t], step, draw);
    sum += filter_row(draw.parameters, weather, rows[t], step, draw.filter).log_density;
  }
  return sum;
}

}  // namespace wheeltap::identification::monitoring::training
