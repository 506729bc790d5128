#include "identification/monitoring/shift_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastShare = 0.01;  // reached by a ramp that begins at the last row

/// Component of one parameter draw of a candidate, for `share` times the shift of the candidate.
ShiftLikelihood::Component component_of(const ShiftPosterior& draw, double log_mass, double share,
                                        const VectorXd& prior_sd) {
  constexpr Index kWidest = kSizes - 1;
  const Index p = prior_sd.size();
  const VectorXd inverse = prior_sd.cwiseInverse();
  const MatrixXd c =
      inverse.asDiagonal() * draw.covariance.middleCols(kWidest * p, p) * inverse.asDiagonal();
  const VectorXd m = draw.mean.col(kWidest).cwiseProduct(inverse);
  // Because C <= I, C⁻¹ - I is positive semidefinite. Rounding may make the eigenvalue of a feature
  // without data slightly negative.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(0.5 * (c + c.transpose())));
  const VectorXd kept = solver.eigenvalues().cwiseMax(1e-14).cwiseMin(1.0);
  const MatrixXd& v = solver.eigenvectors();
  const VectorXd along = v.transpose() * m;
  VectorXd mean = VectorXd::Zero(p), precision = VectorXd::Zero(p);
  double log_ratio = 0.0;
  for (Index i = 0; i < p; ++i) {
    precision[i] = 1.0 / kept[i] - 1.0;
    const double informed = 1.0 - kept[i];
    log_ratio -= 0.5 * std::log(kept[i]);
    if (informed < 1e-9) {
      precision[i] = 0.0;
      continue;
    }
    mean[i] = along[i] / informed;
    // -½ m²/C + ½ mean² precision
    log_ratio += 0.5 * along[i] * along[i] / informed;
  }
  return {.log_weight = log_mass + draw.log_weight(0, kWidest) + log_ratio,
          .mean = share * prior_sd.cwiseProduct(v * mean),
          .precision = inverse.asDiagonal() * (v * precision.asDiagonal() * v.transpose()) *
                       inverse.asDiagonal() / (share * share)};
}

}  // namespace

ShiftLikelihood shift_likelihood(const std::vector<CandidateOnset>& candidates, double hours,
                                 const VectorXd& residual_sd, const LikelihoodLimits& limits) {
  constexpr Index kWidest = kSizes - 1;
  const VectorXd prior_sd = kShiftSizes[kWidest] * residual_sd;
  struct Weighed {
    const ShiftPosterior* draw;
    double log_mass, share, posterior;
  };
  std::vector<Weighed> all;
  for (const CandidateOnset& c : candidates) {
    const double share = std::max(kLeastShare, profile_at(c.profile, hours - c.hours));
    for (const ShiftPosterior& draw : c.draws)
      all.push_back({&draw, c.log_mass(), share, c.log_mass() + draw.log_weight(0, kWidest)});
  }
  std::ranges::stable_sort(all, std::ranges::greater(), &Weighed::posterior);
  ShiftLikelihood out;
  for (const Weighed& one : all) {
    if (static_cast<int>(out.components.size()) == limits.components ||
        one.posterior < all.front().posterior + std::log(limits.negligible))
      break;
    out.components.push_back(component_of(*one.draw, one.log_mass, one.share, prior_sd));
  }
  return out;
}

double log_likelihood(const ShiftLikelihood& likelihood, const VectorXd& shift) {
  double top = -kInfinity;
  std::vector<double> terms;
  for (const auto& c : likelihood.components) {
    const VectorXd from = shift - c.mean;
    terms.push_back(c.log_weight - 0.5 * from.dot(c.precision * from));
    top = std::max(top, terms.back());
  }
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - top);
  return top == -kInfinity ? top : top + std::log(sum);
}

}  // namespace wheeltap::identification::monitoring
