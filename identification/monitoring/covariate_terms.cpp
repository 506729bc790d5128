#include "identification/monitoring/covariate_terms.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::monitoring {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

CovariateScaling::CovariateScaling(const MatrixXd& covariates) {
  std::vector<double> means, sds;
  for (Index c = 0; c < covariates.cols(); ++c) {
    double n = 0.0, sum = 0.0, low = INFINITY, high = -INFINITY;
    for (const double u : covariates.col(c)) {
      if (!std::isfinite(u)) continue;
      n += 1.0;
      sum += u;
      low = std::min(low, u);
      high = std::max(high, u);
    }
    if (n < 2.0 || high - low <= 1e-12 * std::max(std::abs(low), std::abs(high))) continue;
    double squares = 0.0;
    for (const double u : covariates.col(c))
      if (std::isfinite(u)) squares += (u - sum / n) * (u - sum / n);
    used_.push_back(static_cast<int>(c));
    means.push_back(sum / n);
    sds.push_back(std::sqrt(squares / n));
  }
  const auto c = static_cast<Index>(used_.size());
  mean_ = Eigen::Map<const VectorXd>(means.data(), c);
  sd_ = Eigen::Map<const VectorXd>(sds.data(), c);
  // Correlations over rows with both covariates; a ridge keeps the matrix positive definite.
  correlation_ = MatrixXd::Identity(c, c);
  for (Index a = 0; a < c; ++a)
    for (Index b = 0; b < a; ++b) {
      double n = 0.0, sum = 0.0;
      for (Index i = 0; i < covariates.rows(); ++i) {
        const double product = (covariates(i, used_[index(a)]) - mean_[a]) / sd_[a] *
                               ((covariates(i, used_[index(b)]) - mean_[b]) / sd_[b]);
        if (!std::isfinite(product)) continue;
        n += 1.0;
        sum += product;
      }
      if (n > 0.0) correlation_(a, b) = correlation_(b, a) = std::clamp(sum / n, -1.0, 1.0);
    }
  if (c == 0) return;  // no covariate varies, and the decomposition needs one
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation_);
  const VectorXd values = eigen.eigenvalues().cwiseMax(0.0).array() + 1e-3;
  correlation_ = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

CovariateScaling::Scaled CovariateScaling::operator()(const VectorXd& covariates) const {
  const Index c = mean_.size();
  Scaled out{.z = VectorXd::Zero(c), .variance = MatrixXd::Zero(c, c)};
  std::vector<Index> present, missing;
  for (Index i = 0; i < c; ++i) {
    const double z = (covariates[used_[index(i)]] - mean_[i]) / sd_[i];
    if (std::abs(z) <= kLargestDeviation) {  // false for NaN
      out.z[i] = z;
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
    unseen[0] = std::max(0.0, (terms.low - v).maxCoeff());
    unseen[1] = std::max(0.0, (v - terms.high).maxCoeff());
    unseen[2] = std::max(0.0, (terms.long_low - slow).maxCoeff());
    unseen[3] = std::max(0.0, (slow - terms.long_high).maxCoeff());
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
