#include "identification/monitoring/marginal_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/log_gamma.hpp"
#include "base/simd.hpp"
#include "identification/monitoring/baseline_filter.hpp"
#include "identification/monitoring/kernels/evidence_kernel.hpp"

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
      c = std::exp(-step / process.slow_hours);
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

/// Integrates b and σ² over n whitened rows. `gram`: (K + 1) x (K + 1), Σ w wᵀ of w = [X, y].
MarginalLikelihood integrate(const MatrixXd& gram, double log_scales, double n,
                             const RegressionPrior& prior) {
  const Index k = gram.rows() - 1;
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
  out.log_density = -0.5 * (n * std::log(kTwoPi) + log_scales + log_det) +
                    base::log_gamma(out.shape) - base::log_gamma(prior.shape) +
                    prior.shape * std::log(prior.scale) - out.shape * std::log(out.scale);
  return out;
}

const detail::EvidenceKernel& evidence_kernel() {
  static const detail::EvidenceKernel* const widest = [] {
    base::Compiled<detail::EvidenceKernel> compiled{.baseline = &detail::kBaselineEvidence};
#ifdef WHEELTAP_X86_KERNELS
    compiled.avx2 = &detail::kAvx2Evidence;
    compiled.avx512 = &detail::kAvx512Evidence;
#endif
    return base::runnable(compiled).back();
  }();
  return *widest;
}

}  // namespace

MarginalLikelihood marginal_likelihood(const std::vector<double>& hours, const MatrixXd& terms,
                                       const FeatureRows& feature, const ProcessRatios& process,
                                       const RegressionPrior& prior) {
  const Whitened white = whiten(hours, terms, feature, process);
  MatrixXd gram(terms.rows() + 1, terms.rows() + 1);
  gram.noalias() = white.rows * white.rows.transpose();
  return integrate(gram, white.log_scales, static_cast<double>(feature.y.size()), prior);
}

EvidenceData::EvidenceData(const std::vector<double>& hours,
                           const std::vector<FeatureRows>& features, double slow_hours)
    : hours_(hours), features_(features), slow_hours_(slow_hours) {
  constexpr auto kLanes = static_cast<std::size_t>(detail::kLanes);
  for (std::size_t j = 0; j < features.size(); ++j) {
    if (j % kLanes == 0) {
      values_.emplace_back(hours.size() * kLanes, 0.0);
      variances_.emplace_back(hours.size() * kLanes, 0.0);
    }
    for (std::size_t t = 0; t < features[j].rows.size(); ++t) {
      const std::size_t at = index(features[j].rows[t]) * kLanes + j % kLanes;
      values_.back()[at] = features[j].y[static_cast<Index>(t)];
      variances_.back()[at] = 1.0 / features[j].precision[static_cast<Index>(t)];
    }
  }
  for (std::size_t t = 0; t < hours.size(); ++t)
    slow_decay_.push_back(t == 0 ? 1.0 : std::exp(-(hours[t] - hours[t - 1]) / slow_hours));
}

std::vector<MarginalLikelihood> EvidenceData::operator()(
    const MatrixXd& terms, double fast_rate, double slow_ratio, std::span<const double> fast_ratios,
    std::span<const RegressionPrior> priors) const {
  using detail::kLanes;
  const Index k = terms.rows();
  std::vector<MarginalLikelihood> out;
  if (k + 1 > detail::kMostColumns) {
    for (std::size_t j = 0; j < features_.size(); ++j)
      out.push_back(marginal_likelihood(hours_, terms, features_[j],
                                        {.fast_rate = fast_rate,
                                         .fast_ratio = fast_ratios[j],
                                         .slow_ratio = slow_ratio,
                                         .slow_hours = slow_hours_},
                                        priors[j]));
    return out;
  }
  std::vector<double> fast_decay(hours_.size(), 1.0);
  double before = 0.0;
  for (std::size_t t = 1; t < hours_.size(); ++t) {
    const double step = hours_[t] - hours_[t - 1];
    fast_decay[t] = step == before ? fast_decay[t - 1] : std::exp(-fast_rate * step);
    before = step;
  }
  std::vector<double> sums(index((k + 1) * (k + 2) / 2) * kLanes);
  MatrixXd gram(k + 1, k + 1);
  for (std::size_t group = 0; group < values_.size(); ++group) {
    const std::size_t first = group * kLanes;
    const std::size_t features = std::min<std::size_t>(kLanes, features_.size() - first);
    double ratios[kLanes], log_scales[kLanes] = {};
    for (std::size_t l = 0; l < kLanes; ++l)
      ratios[l] = l < features ? fast_ratios[first + l] : 1.0;
    evidence_kernel().accumulate({.rows = static_cast<int>(hours_.size()),
                                  .terms = static_cast<int>(k),
                                  .table = terms.data(),
                                  .values = values_[group].data(),
                                  .variance = variances_[group].data(),
                                  .fast_decay = fast_decay.data(),
                                  .slow_decay = slow_decay_.data(),
                                  .fast_ratio = ratios,
                                  .slow_ratio = slow_ratio},
                                 static_cast<int>(features),
                                 {.gram = sums.data(), .log_scales = log_scales});
    for (std::size_t l = 0; l < features; ++l) {
      std::size_t at = l;
      for (Index a = 0; a <= k; ++a)
        for (Index b = 0; b <= a; ++b, at += kLanes) gram(a, b) = gram(b, a) = sums[at];
      out.push_back(integrate(gram, log_scales[l],
                              static_cast<double>(features_[first + l].y.size()),
                              priors[first + l]));
    }
  }
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
