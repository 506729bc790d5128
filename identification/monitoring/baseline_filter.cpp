#include "identification/monitoring/baseline_filter.hpp"

#include <cmath>

#include "base/constants.hpp"
#include "base/log_gamma.hpp"

namespace wheeltap::identification::monitoring {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double log_innovation_density(double v, double s, double degrees) {
  if (degrees == kGaussian) return -0.5 * (std::log(kTwoPi * s) + v * v / s);
  return base::log_gamma(0.5 * (degrees + 1.0)) - base::log_gamma(0.5 * degrees) -
         0.5 * std::log(degrees * kPi * s) -
         0.5 * (degrees + 1.0) * std::log1p(v * v / (degrees * s));
}

Weather weather_at(const CovariateTerms& terms, const CovariateScaling::Scaled& scaled,
                   const VectorXd& v, const VectorXd& slow) {
  const VectorXd phi = terms_at(terms, v, slow);
  Weather out;
  out.h.resize(phi.size() + 2);
  out.h << phi, 1.0, 1.0;
  if (scaled.imputed) {
    const MatrixXd slopes = term_slopes(terms, v);
    out.term_covariance = slopes * scaled.variance * slopes.transpose();
  }
  return out;
}

BaselineFilter::BaselineFilter(const BaselineParameters& b) : block_(b.block()) {
  const Index n = b.features(), width = block_, terms = width - 2;
  x = VectorXd::Zero(n * width);
  p = MatrixXd::Zero(n * width, n * width);
  for (Index j = 0; j < n; ++j) {
    x.segment(j * width, terms) = b.coefficient_mean.col(j);
    p.diagonal().segment(j * width, terms) = b.coefficient_sd.col(j).array().square();
  }
  reset_drift(b);
}

void BaselineFilter::reset_drift(const BaselineParameters& b) {
  const Index n = b.features(), terms = block_ - 2;
  for (Index j = 0; j < n; ++j)
    for (Index d = j * block_ + terms; d < (j + 1) * block_; ++d) {
      x[d] = 0.0;
      p.row(d).setZero();
      p.col(d).setZero();
    }
  for (Index j = 0; j < n; ++j) {
    const Index d = j * block_ + terms;
    for (Index k = 0; k < n; ++k)
      p(d, k * block_ + terms) = b.fast_sd[j] * b.correlation(j, k) * b.fast_sd[k];
    p(d + 1, d + 1) = b.slow_sd[j] * b.slow_sd[j];
  }
}

void BaselineFilter::predict(const BaselineParameters& b, double hours) {
  const double fast = std::exp(-b.fast_rate * hours), slow = std::exp(-hours / b.slow_hours);
  const Index n = b.features();
  for (Index j = 0; j < n; ++j) {
    const Index d = (j + 1) * block_ - 2;
    x[d] *= fast;
    x[d + 1] *= slow;
    p.row(d) *= fast;
    p.col(d) *= fast;
    p.row(d + 1) *= slow;
    p.col(d + 1) *= slow;
    p(d + 1, d + 1) += (1.0 - slow * slow) * b.slow_sd[j] * b.slow_sd[j];
  }
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < n; ++k)
      p((j + 1) * block_ - 2, (k + 1) * block_ - 2) +=
          (1.0 - fast * fast) * b.fast_sd[j] * b.correlation(j, k) * b.fast_sd[k];
}

void BaselineFilter::observe(int feature, const VectorXd& h, VectorXd& covariance) const {
  covariance.noalias() = p.middleCols(feature * block_, block_) * h;
}

double BaselineFilter::mean(int feature, const VectorXd& h) const {
  return x.segment(feature * block_, block_).dot(h);
}

double BaselineFilter::variance(int feature, const VectorXd& h, const VectorXd& covariance) const {
  return std::max(0.0, covariance.segment(feature * block_, block_).dot(h));
}

void BaselineFilter::update(const VectorXd& covariance, double v, double s) {
  x += (v / s) * covariance;
  const VectorXd scaled = covariance / std::sqrt(s);
  p.noalias() -= scaled * scaled.transpose();
}

double BaselineFilter::imputation_variance(int feature, const Weather& weather) const {
  if (weather.term_covariance.size() == 0) return 0.0;
  const Index terms = weather.term_covariance.rows();
  const auto b = x.segment(feature * block_, terms);
  return std::max(0.0, b.dot(weather.term_covariance * b));
}

double noise_variance(const BaselineParameters& b, const Weather& weather, const Row& row,
                      const BaselineFilter& filter, int feature) {
  return b.noise_sd[feature] * b.noise_sd[feature] * row.relative_variance[feature] +
         filter.imputation_variance(feature, weather);
}

RowPrediction filter_row(const BaselineParameters& b, const Weather& weather, const Row& row,
                         double hours, BaselineFilter& filter) {
  const int n = b.features();
  RowPrediction out{
      .mean = VectorXd(n), .sd = VectorXd(n), .standardised = VectorXd::Constant(n, kNaN)};
  filter.predict(b, hours);
  VectorXd covariance;
  const double spread =
      b.degrees > 2.0 && b.degrees < kGaussian ? b.degrees / (b.degrees - 2.0) : 1.0;
  for (int j = 0; j < n; ++j) {
    filter.observe(j, weather.h, covariance);
    out.mean[j] = filter.mean(j, weather.h);
    out.sd[j] = std::sqrt(filter.variance(j, weather.h, covariance) +
                          spread * noise_variance(b, weather, row, filter, j));
  }
  for (int j = 0; j < n; ++j) {
    if (!std::isfinite(row.features[j])) continue;
    filter.observe(j, weather.h, covariance);
    const double noise = noise_variance(b, weather, row, filter, j);
    const double s = filter.variance(j, weather.h, covariance) + noise;
    const double v = row.features[j] - filter.mean(j, weather.h);
    out.standardised[j] = v / std::sqrt(s);
    out.log_density += log_innovation_density(v, s, b.degrees);
    filter.update(covariance, v, s + noise * (noise_inflation(v, s, b.degrees) - 1.0));
  }
  return out;
}

}  // namespace wheeltap::identification::monitoring
