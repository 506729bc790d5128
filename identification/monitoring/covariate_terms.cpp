#include "identification/monitoring/covariate_terms.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::monitoring {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Column {
  double n = 0.0, mean = 0.0, sd = 0.0, low = kInfinity, high = -kInfinity;
  double step = 0.0;  ///< largest change between two consecutive rows
};

/// Statistics of the finite entries, without those more than kLargestDeviation sds of `former` from
/// its mean.
Column column_of(const MatrixXd& covariates, Index c, const Column* former) {
  Column out;
  double sum = 0.0, squares = 0.0, last = kNaN;
  const auto is_used = [&](double u) {
    return std::isfinite(u) &&
           (former == nullptr || std::abs(u - former->mean) <= kLargestDeviation * former->sd);
  };
  for (const double u : covariates.col(c)) {
    if (is_used(u)) {
      out.n += 1.0;
      sum += u;
      out.low = std::min(out.low, u);
      out.high = std::max(out.high, u);
      if (std::isfinite(last)) out.step = std::max(out.step, std::abs(u - last));
    }
    last = is_used(u) ? u : kNaN;
  }
  out.mean = sum / out.n;
  for (const double u : covariates.col(c))
    if (is_used(u)) squares += (u - out.mean) * (u - out.mean);
  out.sd = std::sqrt(squares / out.n);
  return out;
}

bool varies(const Column& of) {
  return of.n >= 2.0 && of.high - of.low > 1e-12 * std::max(std::abs(of.low), std::abs(of.high));
}

}  // namespace

CovariateScaling::CovariateScaling(const MatrixXd& covariates) {
  std::vector<double> means, sds, lows, highs, jumps;
  for (Index c = 0; c < covariates.cols(); ++c) {
    const Column all = column_of(covariates, c, nullptr);
    if (!varies(all)) continue;
    const Column usual = column_of(covariates, c, &all);
    const Column& of = varies(usual) ? usual : all;
    used_.push_back(static_cast<int>(c));
    means.push_back(of.mean);
    sds.push_back(of.sd);
    lows.push_back((of.low - of.mean) / of.sd);
    highs.push_back((of.high - of.mean) / of.sd);
    jumps.push_back(std::max(kLargestJump, 2.0 * of.step / of.sd));
  }
  const auto c = static_cast<Index>(used_.size());
  mean_ = Eigen::Map<const VectorXd>(means.data(), c);
  sd_ = Eigen::Map<const VectorXd>(sds.data(), c);
  low_ = Eigen::Map<const VectorXd>(lows.data(), c);
  high_ = Eigen::Map<const VectorXd>(highs.data(), c);
  jump_ = Eigen::Map<const VectorXd>(jumps.data(), c);
  // Correlations over rows with both covariates; a ridge keeps the matrix positive definite.
  correlation_ = MatrixXd::Identity(c, c);
  for (Index a = 0; a < c; ++a)
    for (Index b = 0; b < a; ++b) {
      double n = 0.0, sum = 0.0;
      for (Index i = 0; i < covariates.rows(); ++i) {
        const double of_a = (covariates(i, used_[index(a)]) - mean_[a]) / sd_[a];
        const double of_b = (covariates(i, used_[index(b)]) - mean_[b]) / sd_[b];
        // False for missing values and for codes such as -999, which `impute` also replaces.
        if (!(std::abs(of_a) <= kLargestDeviation && std::abs(of_b) <= kLargestDeviation)) continue;
        n += 1.0;
        sum += of_a * of_b;
      }
      if (n > 0.0) correlation_(a, b) = correlation_(b, a) = std::clamp(sum / n, -1.0, 1.0);
    }
  if (c == 0) return;  // no covariate varies, and the decomposition needs one
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation_);
  const VectorXd values = eigen.eigenvalues().cwiseMax(0.0).array() + 1e-3;
  correlation_ = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

CovariateScaling::Scaled CovariateScaling::operator()(const VectorXd& covariates) const {
  return impute((covariates(used_) - mean_).cwiseQuotient(sd_));
}

CovariateScaling::Scaled CovariateScaling::operator()(const VectorXd& covariates,
                                                      LastCovariates& last) const {
  VectorXd z = (covariates(used_) - mean_).cwiseQuotient(sd_);
  const VectorXd read = z;
  if (last.read.size() != z.size()) last.read = last.used = VectorXd::Constant(z.size(), kNaN);
  for (Index i = 0; i < z.size(); ++i) {
    if (!std::isfinite(read[i])) continue;
    const auto is_near = [&](double other) { return std::abs(read[i] - other) <= jump_[i]; };
    const bool is_usual = read[i] >= low_[i] - jump_[i] && read[i] <= high_[i] + jump_[i];
    if (!is_usual && !is_near(last.read[i]) && !is_near(last.used[i])) z[i] = kNaN;
    last.read[i] = read[i];
    if (std::isfinite(z[i])) last.used[i] = z[i];
  }
  Scaled out = impute(z);
  // The weather may be as extreme as the reading that is not used.
  for (Index i = 0; i < z.size(); ++i)
    if (!std::isfinite(z[i]) && std::abs(read[i]) <= kLargestDeviation)
      out.variance(i, i) = std::max(out.variance(i, i), std::pow(read[i] - out.z[i], 2));
  return out;
}

CovariateScaling::Scaled CovariateScaling::impute(const VectorXd& z) const {
  const Index c = mean_.size();
  Scaled out{.z = VectorXd::Zero(c), .variance = MatrixXd::Zero(c, c)};
  std::vector<Index> present, missing;
  for (Index i = 0; i < c; ++i) {
    if (std::abs(z[i]) <= kLargestDeviation) {  // false for NaN
      out.z[i] = z[i];
      present.push_back(i);
    } else {
      missing.push_back(i);
    }
  }
  if (missing.empty()) return out;
  out.imputed = true;
  MatrixXd block = correlation_(missing, missing);
  if (!present.empty()) {
    const MatrixXd across = correlation_(missing, present);
    const Eigen::LLT<MatrixXd> inner(MatrixXd(correlation_(present, present)));
    const VectorXd known = out.z(present);
    const VectorXd imputed = across * inner.solve(known);
    out.z(missing) = imputed;
    block -= across * inner.solve(MatrixXd(across.transpose()));
  }
  out.variance(missing, missing) = block;
  return out;
}

void follow_lag(const VectorXd& z, double hours, double lag_hours, VectorXd& v) {
  if (v.size() != z.size() || !(lag_hours > 0.0)) {
    v = z;
    return;
  }
  v += -std::expm1(-hours / lag_hours) * (z - v);
}

VectorXd terms_at(const CovariateTerms& terms, const VectorXd& v, const VectorXd& slow) {
  const Index c = v.size(), hinges = static_cast<Index>(terms.knots.size());
  VectorXd phi = VectorXd::Zero(terms.size(static_cast<int>(c)));
  phi[0] = 1.0;
  phi.segment(1, c) = v;
  for (Index h = 0; h < hinges; ++h)
    phi[1 + c + h] = std::max(0.0, v[terms.hinge_of[index(h)]] - terms.knots[index(h)]);
  if (c > 0 && terms.low.size() == c) {
    double* unseen = phi.data() + 1 + c + hinges;
    for (const double u : {(terms.low - v).maxCoeff(), (v - terms.high).maxCoeff(),
                           (terms.long_low - slow).maxCoeff(), (slow - terms.long_high).maxCoeff()})
      for (int segment = 0; segment < kUnseenSegments; ++segment) {
        const double left = kUnseenKnots[segment];
        const double length =
            segment + 1 < kUnseenSegments ? kUnseenKnots[segment + 1] - left : kInfinity;
        *unseen++ = std::clamp(u - left, 0.0, length);
      }
  }
  return phi;
}

MatrixXd term_slopes(const CovariateTerms& terms, const VectorXd& v) {
  const Index c = v.size(), hinges = static_cast<Index>(terms.knots.size());
  MatrixXd out = MatrixXd::Zero(terms.size(static_cast<int>(c)), c);
  out.middleRows(1, c).setIdentity();
  for (Index h = 0; h < hinges; ++h)
    if (v[terms.hinge_of[index(h)]] > terms.knots[index(h)])
      out(1 + c + h, terms.hinge_of[index(h)]) = 1.0;
  return out;
}

}  // namespace wheeltap::identification::monitoring
