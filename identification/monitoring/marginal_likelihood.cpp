#include "identification/monitoring/marginal_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/log_gamma.hpp"
#include "identification/monitoring/baseline_filter.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Whitened {
  MatrixXd rows;            ///< innovations of [X, y] divided by their scale
  double log_scales = 0.0;  ///< Σ ln of the innovations' variances
};

/// One row of the filter over all columns; `__restrict` allows vector instructions.
inline void filter_columns(Index k, double a, double c, double to_fast, double to_slow,
                           double scale, double* __restrict fast, double* __restrict slow,
                           double* __restrict column) {
  for (Index i = 0; i < k; ++i) {
    const double fi = a * fast[i], li = c * slow[i], v = column[i] - fi - li;
    fast[i] = fi + to_fast * v;
    slow[i] = li + to_slow * v;
    column[i] = scale * v;
  }
}

/// The filter of (d, s) with σ = 1, over the columns of [X, y].
Whitened whiten(const std::vector<double>& hours, const MatrixXd& terms, const FeatureRows& feature,
                const ProcessRatios& process) {
  const Index n = feature.y.size(), k = terms.rows() + 1;
  MatrixXd data(k, n);  // the entries of one time are contiguous
  for (Index t = 0; t < n; ++t) {
    const double* from = terms.col(feature.rows[index(t)]).data();
    std::copy(from, from + k - 1, data.col(t).data());
    data(k - 1, t) = feature.y[t];
  }
  VectorXd fast = VectorXd::Zero(k), slow = VectorXd::Zero(k);
  double ff = process.fast_ratio, fs = 0.0, ss = process.slow_ratio;
  Whitened out;
  const VectorXd variance = feature.precision.cwiseInverse();
  double before = hours[index(feature.rows[0])], step = -1.0, a = 1.0, c = 1.0, product = 1.0;
  for (Index t = 0; t < n; ++t) {
    const double now = hours[index(feature.rows[index(t)])];
    if (now - before != step) {
      step = now - before;
      a = std::exp(-process.fast_rate * step);
      c = std::exp(-step / kSlowHours);
    }
    before = now;
    ff = a * a * ff + (1.0 - a * a) * process.fast_ratio;
    ss = c * c * ss + (1.0 - c * c) * process.slow_ratio;
    fs *= a * c;
    const double gf = ff + fs, gs = fs + ss, s = gf + gs + variance[t];
    const double inverse = 1.0 / s;
    const double to_fast = gf * inverse, to_slow = gs * inverse;
    filter_columns(k, a, c, to_fast, to_slow, std::sqrt(inverse), fast.data(), slow.data(),
                   data.col(t).data());
    ff -= gf * to_fast;
    fs -= gf * to_slow;
    ss -= gs * to_slow;
    product *= s;
    if (t % 16 == 15) {
      out.log_scales += std::log(product);
      product = 1.0;
    }
  }
  out.log_scales += std::log(product);
  out.rows = std::move(data);
  return out;
}

}  // namespace

MarginalLikelihood marginal_likelihood(const std::vector<double>& hours, const MatrixXd& terms,
                                       const FeatureRows& feature, const ProcessRatios& process,
                                       const RegressionPrior& prior) {
  const Index k = terms.rows();
  const auto n = static_cast<double>(feature.y.size());
  const Whitened white = whiten(hours, terms, feature, process);
  MatrixXd gram(k + 1, k + 1);
  gram.noalias() = white.rows * white.rows.transpose();
  MatrixXd precision = gram.topLeftCorner(k, k);
  precision.diagonal().array() += prior.coefficient_scale.array().square().inverse();
  const Eigen::LLT<MatrixXd> factor(precision);
  MarginalLikelihood out;
  const VectorXd right = gram.col(k).head(k);
  out.coefficients = factor.solve(right);
  out.shape = prior.shape + 0.5 * n;
  out.scale = prior.scale + 0.5 * std::max(0.0, gram(k, k) - right.dot(out.coefficients));
  const double log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum() +
                         2.0 * prior.coefficient_scale.array().log().sum();
  out.log_density = -0.5 * (n * std::log(kTwoPi) + white.log_scales + log_det) +
                    base::log_gamma(out.shape) - base::log_gamma(prior.shape) +
                    prior.shape * std::log(prior.scale) - out.shape * std::log(out.scale);
  return out;
}

VectorXd whitened_residuals(const std::vector<double>& hours, const MatrixXd& terms,
                            const FeatureRows& feature, const ProcessRatios& process,
                            const VectorXd& coefficients) {
  const Whitened white = whiten(hours, terms, feature, process);
  const Index k = terms.rows();
  return white.rows.row(k).transpose() - white.rows.topRows(k).transpose() * coefficients;
}

}  // namespace wheeltap::identification::monitoring
