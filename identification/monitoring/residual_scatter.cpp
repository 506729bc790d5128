#include "identification/monitoring/residual_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Scatter robust_scatter(const MatrixXd& residuals) {
  const Index p = residuals.cols();
  Scatter out{.median = VectorXd(p), .sd = VectorXd(p), .covariance = {}};
  MatrixXd z = residuals;
  for (Index j = 0; j < p; ++j) {
    std::vector<double> values;
    for (const double r : residuals.col(j))
      if (std::isfinite(r)) values.push_back(r);
    out.median[j] = middle_of(values);
    for (double& r : values) r = std::abs(r - out.median[j]);
    out.sd[j] = std::max(1.4826 * middle_of(values), 1e-12);
    z.col(j) = ((z.col(j).array() - out.median[j]) / out.sd[j]);
  }
  MatrixXd correlation = MatrixXd::Identity(p, p);
  for (Index a = 0; a < p; ++a)
    for (Index b = 0; b < a; ++b) {
      double aa = 0.0, bb = 0.0, ab = 0.0;
      for (Index t = 0; t < z.rows(); ++t) {
        if (!std::isfinite(z(t, a)) || !std::isfinite(z(t, b))) continue;
        const double za = std::clamp(z(t, a), -3.0, 3.0), zb = std::clamp(z(t, b), -3.0, 3.0);
        aa += za * za;
        bb += zb * zb;
        ab += za * zb;
      }
      correlation(a, b) = correlation(b, a) =
          aa > 0.0 && bb > 0.0 ? std::clamp(ab / std::sqrt(aa * bb), -0.999, 0.999) : 0.0;
    }
  // A matrix of pairwise correlations may have negative eigenvalues.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
  const VectorXd values = eigen.eigenvalues().cwiseMax(1e-3);
  correlation = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
  out.covariance = out.sd.asDiagonal() * correlation * out.sd.asDiagonal();
  return out;
}

double squared_distance(const Scatter& scatter, const VectorXd& residuals) {
  std::vector<Index> present;
  for (Index j = 0; j < residuals.size(); ++j)
    if (std::isfinite(residuals[j])) present.push_back(j);
  if (present.empty()) return kNaN;
  const MatrixXd covariance = scatter.covariance(present, present);
  const VectorXd r = residuals(present) - scatter.median(present);
  return r.dot(Eigen::LLT<MatrixXd>(covariance).solve(r));
}

}  // namespace wheeltap::identification::monitoring
