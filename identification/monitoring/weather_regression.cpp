#include "identification/monitoring/weather_regression.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "identification/monitoring/residual_scatter.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double covariance_of(const VectorXd& a, const VectorXd& b, double length) {
  const auto c = static_cast<double>(a.size());
  return std::exp(-(a - b).squaredNorm() / (2.0 * c * length * length)) + 0.1 * a.dot(b) / c;
}

MatrixXd kernel_matrix(const MatrixXd& points, double length) {
  const Index n = points.cols();
  MatrixXd out(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k <= i; ++k)
      out(i, k) = out(k, i) = covariance_of(points.col(i), points.col(k), length);
  return out;
}

}  // namespace

HingeRegression::HingeRegression(const Series& learning) : scaling_(learning.covariates) {
  const Index n = learning.rows(), p = learning.feature_count();
  MatrixXd z(n, scaling_.count());
  for (Index t = 0; t < n; ++t)
    z.row(t) = scaling_(learning.covariates.row(t).transpose()).z.transpose();
  for (int c = 0; c < scaling_.count(); ++c) {
    VectorXd sorted = z.col(c);
    std::sort(sorted.data(), sorted.data() + n);
    const double zero = -scaling_.mean(c) / scaling_.sd(c);
    for (const double knot : {sorted[n / 2], zero}) {
      // A hinge needs a twentieth of the rows on each side.
      if (knot <= sorted[n / 20] || knot >= sorted[n - 1 - n / 20]) continue;
      hinge_of_.push_back(c);
      knots_.push_back(knot);
    }
  }
  MatrixXd table(1 + scaling_.count() + static_cast<Index>(knots_.size()), n);
  for (Index t = 0; t < n; ++t) table.col(t) = terms(learning.covariates.row(t).transpose());
  coefficients_ = MatrixXd::Zero(table.rows(), p);
  for (Index j = 0; j < p; ++j) {
    VectorXd weight(n);
    for (Index t = 0; t < n; ++t) weight[t] = std::isfinite(learning.features(t, j)) ? 1.0 : 0.0;
    const VectorXd present = weight;
    for (int pass = 0; pass < 4; ++pass) {
      MatrixXd gram = table * weight.asDiagonal() * table.transpose();
      gram.diagonal().array() += 1e-6 * weight.sum();
      VectorXd right = VectorXd::Zero(table.rows());
      for (Index t = 0; t < n; ++t)
        if (weight[t] > 0.0) right += weight[t] * learning.features(t, j) * table.col(t);
      coefficients_.col(j) = Eigen::LLT<MatrixXd>(gram).solve(right);
      const VectorXd r = learning.features.col(j) - table.transpose() * coefficients_.col(j);
      const double sd = robust_scatter(r).sd[0];
      constexpr double kDegrees = 5.0;
      for (Index t = 0; t < n; ++t)
        if (present[t] > 0.0) weight[t] = (kDegrees + 1.0) / (kDegrees + r[t] * r[t] / (sd * sd));
    }
  }
}

VectorXd HingeRegression::terms(const VectorXd& covariates) const {
  const Index c = scaling_.count();
  const VectorXd z = scaling_(covariates).z;
  VectorXd out(1 + c + static_cast<Index>(knots_.size()));
  out[0] = 1.0;
  out.segment(1, c) = z;
  for (std::size_t h = 0; h < knots_.size(); ++h)
    out[1 + c + static_cast<Index>(h)] = std::max(0.0, z[hinge_of_[h]] - knots_[h]);
  return out;
}

VectorXd HingeRegression::residuals(const Row& row) const {
  return row.features - coefficients_.transpose() * terms(row.covariates);
}

ProcessRegression::ProcessRegression(const Series& learning) : scaling_(learning.covariates) {
  for (Index j = 0; j < learning.feature_count(); ++j) {
    std::vector<Index> rows;
    for (Index t = 0; t < learning.rows(); ++t)
      if (std::isfinite(learning.features(t, j))) rows.push_back(t);
    const std::size_t n = std::min<std::size_t>(rows.size(), kMostPoints);
    MatrixXd points(scaling_.count(), static_cast<Index>(n));
    VectorXd values(static_cast<Index>(n));
    for (std::size_t i = 0; i < n; ++i) {
      const Index t = rows[i * rows.size() / n];
      points.col(static_cast<Index>(i)) = scaling_(learning.covariates.row(t).transpose()).z;
      values[static_cast<Index>(i)] = learning.features(t, j);
    }
    features_.push_back(fit(points, values));
  }
}

ProcessRegression::Feature ProcessRegression::fit(const MatrixXd& points, const VectorXd& values) {
  // Clip outliers, because the model's noise is Gaussian.
  const Scatter scatter = robust_scatter(values);
  const double mean = scatter.median[0], wide = 6.0 * scatter.sd[0];
  const VectorXd y = (values.array() - mean).max(-wide).min(wide);
  const Index n = y.size();
  Feature best;
  double top = -kInfinity;
  for (const double length : {0.3, 0.6, 1.2, 2.5}) {
    const MatrixXd kernel = kernel_matrix(points, length);
    for (const double noise : {0.01, 0.03, 0.1, 0.3, 1.0}) {
      MatrixXd noisy = kernel;
      noisy.diagonal().array() += noise;
      const Eigen::LLT<MatrixXd> factor(noisy);
      const VectorXd weights = factor.solve(y);
      const double variance = y.dot(weights) / static_cast<double>(n);
      const double evidence = -0.5 * static_cast<double>(n) * std::log(variance) -
                              factor.matrixLLT().diagonal().array().log().sum();
      if (evidence <= top) continue;
      top = evidence;
      best = {.points = points,
              .weights = weights,
              .mean = mean,
              .length = length,
              .noise = noise,
              .variance = variance};
    }
  }
  MatrixXd noisy = kernel_matrix(points, best.length);
  noisy.diagonal().array() += best.noise;
  best.inverse = Eigen::LLT<MatrixXd>(noisy).solve(MatrixXd::Identity(n, n));
  return best;
}

VectorXd ProcessRegression::residuals(const Row& row) const {
  const VectorXd z = scaling_(row.covariates).z;
  VectorXd out(row.features.size());
  for (Index j = 0; j < out.size(); ++j) {
    const Feature& f = features_[index(j)];
    VectorXd k(f.points.cols());
    for (Index i = 0; i < k.size(); ++i) k[i] = covariance_of(f.points.col(i), z, f.length);
    const double explained = k.dot(f.inverse * k);
    const double variance =
        std::max(f.noise, covariance_of(z, z, f.length) + f.noise - explained) * f.variance;
    out[j] = (row.features[j] - f.mean - k.dot(f.weights)) / std::sqrt(variance);
  }
  return out;
}

}  // namespace wheeltap::identification::monitoring
