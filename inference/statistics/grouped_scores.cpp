#include "inference/statistics/grouped_scores.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// s² of each component, for a resample with the estimate z* + `moved`. `times` is the number of
/// draws of each group. `information` is the sum of P and the information of the resample.
VectorXd jackknife(std::span<const GroupScore> groups, const std::vector<int>& times,
                   const MatrixXd& information, const VectorXd& moved) {
  const auto n = static_cast<double>(groups.size());
  VectorXd sum = VectorXd::Zero(moved.size());
  for (std::size_t w = 0; w < groups.size(); ++w) {
    if (times[w] == 0) continue;
    const VectorXd score = groups[w].score - groups[w].information * moved;
    const Eigen::LLT<MatrixXd> rest(information - groups[w].information);
    // If the posterior of the other groups has no mode, the information of all groups is used.
    const VectorXd step = rest.info() == Eigen::Success ? rest.solve(score).eval()
                                                        : information.ldlt().solve(score).eval();
    sum += times[w] * step.cwiseAbs2();
  }
  return (n - 1.0) / n * sum;
}

void require(std::span<const GroupScore> groups, const MatrixXd& prior_information) {
  if (groups.size() < 2)
    throw std::invalid_argument("grouped errors: " + std::to_string(groups.size()) +
                                " groups, but at least 2 are required");
  const Eigen::Index d = prior_information.rows();
  for (const GroupScore& g : groups)
    if (g.score.size() != d || g.information.rows() != d || g.information.cols() != d)
      throw std::invalid_argument("grouped errors: a score of " + std::to_string(g.score.size()) +
                                  " components, must be " + std::to_string(d));
}

}  // namespace

double GroupedError::quantile(double p) const {
  if (!(p > 0.0 && p < 1.0))
    throw std::invalid_argument("quantile of p = " + std::to_string(p) + ", must be in (0, 1)");
  if (p == 0.5) return 0.0;
  const bool above = p > 0.5;
  const double tail = above ? 1.0 - p : p;
  double reach = boost::math::quantile(boost::math::students_t(groups - 1), 1.0 - tail);
  if (!studentized.empty()) {
    const auto last = static_cast<double>(studentized.size() - 1);
    const auto at = static_cast<std::size_t>(std::lround((above ? tail : 1.0 - tail) * last));
    reach = std::max(reach, above ? -studentized[at] : studentized[at]);
  }
  return (above ? sd : -sd) * reach;
}

std::vector<GroupedError> grouped_errors(std::span<const GroupScore> groups,
                                         const MatrixXd& prior_information,
                                         const GroupedErrorOptions& options) {
  require(groups, prior_information);
  const Eigen::Index d = prior_information.rows();
  const int n = static_cast<int>(groups.size());
  MatrixXd information = prior_information;
  VectorXd score = VectorXd::Zero(d);
  for (const GroupScore& g : groups) information += g.information, score += g.score;
  const Eigen::LLT<MatrixXd> all(information);
  if (all.info() != Eigen::Success) return {};
  const MatrixXd covariance = all.solve(MatrixXd::Identity(d, d));
  const VectorXd variance =
      jackknife(groups, std::vector<int>(groups.size(), 1), information, VectorXd::Zero(d))
          .cwiseMax(covariance.diagonal());
  std::vector<GroupedError> out(static_cast<std::size_t>(d));
  for (Eigen::Index i = 0; i < d; ++i) {
    out[static_cast<std::size_t>(i)] = {.sd = std::sqrt(variance[i]), .groups = n};
  }
  std::vector<int> times(groups.size());
  for (int b = 0; b < options.resamples; ++b) {
    base::Random random(options.seed, 0, static_cast<std::uint64_t>(b), base::Purpose::simulation);
    std::ranges::fill(times, 0);
    MatrixXd drawn = prior_information;
    VectorXd pull = -score;
    for (int k = 0; k < n; ++k) {
      const auto w = static_cast<std::size_t>(random.index(n));
      ++times[w], drawn += groups[w].information, pull += groups[w].score;
    }
    if (std::ranges::count(times, 0) == n - 1) continue;  // one repeated group has no scatter
    const Eigen::LLT<MatrixXd> fit(drawn);
    if (fit.info() != Eigen::Success) continue;
    const VectorXd moved = fit.solve(pull);
    const VectorXd squares = jackknife(groups, times, drawn, moved);
    for (Eigen::Index i = 0; i < d; ++i) {
      const double t = moved[i] / std::sqrt(squares[i]);
      if (std::isfinite(t)) out[static_cast<std::size_t>(i)].studentized.push_back(t);
    }
  }
  for (GroupedError& error : out) std::ranges::sort(error.studentized);
  return out;
}

}  // namespace wheeltap::inference
