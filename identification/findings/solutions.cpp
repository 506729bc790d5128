#include "identification/findings/solutions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using inference::Posterior;

constexpr double kFarthest = 8.0;  // in standard normal coordinates
constexpr double kGap = 3.0, kOfNeighbours = 0.95;
constexpr std::size_t kCompared = 2000;  // draws used to measure gaps
constexpr double kLeastVariance = 1e-12;
constexpr std::size_t kMostDraws = 200'000;  // longer runs are thinned to this

/// Coordinates in which a covariance is the identity.
class Metric {
 public:
  explicit Metric(MatrixXd covariance) {
    covariance.diagonal().array() += kLeastVariance;
    llt_.compute(covariance);
  }
  [[nodiscard]] VectorXd scaled(const VectorXd& z) const { return llt_.matrixL().solve(z); }

 private:
  Eigen::LLT<MatrixXd> llt_;
};

/// The draws of a model in standard normal coordinates, one per column, and their log posterior.
struct Draws {
  MatrixXd z;
  std::vector<double> log_posterior;
  std::vector<std::size_t> of_chain;  // index of each chain's first draw, then the number of draws
};

Draws draws_of_model(const Posterior& posterior, int model) {
  const inference::ModelSpace& space = *posterior.space;
  const auto d = static_cast<Index>(space[model].dimension);
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::size_t all = 0, count = 0;
  for (const auto& chain : posterior.chains) all += chain.size();
  const std::size_t step = std::max<std::size_t>(1, (all + kMostDraws - 1) / kMostDraws);
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.size(); i += step) count += chain.model[i] == model ? 1 : 0;
  Draws out{.z = MatrixXd(d, static_cast<Index>(count)), .log_posterior = {}, .of_chain = {0}};
  Index at = 0;
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.size(); i += step) {
      if (chain.model[i] != model) continue;
      for (Index p = 0; p < d; ++p)
        out.z(p, at) = std::clamp(
            space.prior(model, static_cast<int>(p))
                .to_standard_normal(chain.theta[i * width + static_cast<std::size_t>(p)]),
            -kFarthest, kFarthest);
      out.log_posterior.push_back(chain.log_prior[i] + chain.log_likelihood[i]);
      ++at;
    }
    out.of_chain.push_back(static_cast<std::size_t>(at));
    chain.let_go();
  }
  return out;
}

VectorXd mean_of(const Draws& draws, const std::vector<int>& of, int which, double& count) {
  VectorXd mean = VectorXd::Zero(draws.z.rows());
  count = 0.0;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i] == which) mean += draws.z.col(static_cast<Index>(i)), ++count;
  return mean / std::max(1.0, count);
}

/// Covariance of the deviations of all draws from the mean of their group.
MatrixXd covariance_within(const Draws& draws, const std::vector<int>& of, int groups) {
  MatrixXd sum = MatrixXd::Zero(draws.z.rows(), draws.z.rows());
  for (int k = 0; k < groups; ++k) {
    double count = 0.0;
    const VectorXd mean = mean_of(draws, of, k, count);
    for (std::size_t i = 0; i < of.size(); ++i)
      if (of[i] == k) {
        const VectorXd off = draws.z.col(static_cast<Index>(i)) - mean;
        sum += off * off.transpose();
      }
  }
  return sum / static_cast<double>(of.size());
}

/// Assigns each draw to the nearest mode. Distances are scaled by the covariance of the draws about
/// their mode; the iteration starts from the covariance of all draws. Modes without draws get no
/// number; numbers start at 0.
std::vector<int> nearest_modes(const Posterior& posterior, int model, const Draws& draws,
                               int& groups) {
  constexpr int kRounds = 8;
  const inference::ModelSpace& space = *posterior.space;
  std::vector<VectorXd> centres;
  for (const auto& mode : posterior.found[static_cast<std::size_t>(model)].modes) {
    VectorXd z(draws.z.rows());
    for (Index p = 0; p < z.size(); ++p)
      z[p] = std::clamp(space.prior(model, static_cast<int>(p))
                            .to_standard_normal(mode.x[static_cast<std::size_t>(p)]),
                        -kFarthest, kFarthest);
    centres.push_back(std::move(z));
  }
  std::vector<int> of(draws.log_posterior.size(), 0);
  const auto modes = static_cast<int>(centres.size());
  for (int round = 0; round < kRounds; ++round) {
    const Metric metric(covariance_within(draws, of, modes));
    std::vector<VectorXd> scaled;
    for (const VectorXd& centre : centres) scaled.emplace_back(metric.scaled(centre));
    bool settled = round > 0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const VectorXd z = metric.scaled(draws.z.col(static_cast<Index>(i)));
      const auto nearest = std::ranges::min_element(
          scaled, {}, [&](const VectorXd& centre) { return (z - centre).squaredNorm(); });
      const auto k = static_cast<int>(nearest - scaled.begin());
      settled = settled && k == of[i];
      of[i] = k;
    }
    if (settled) break;
  }
  std::vector<int> number(centres.size(), -1);
  groups = 0;
  for (int& k : of) {
    int& own = number[static_cast<std::size_t>(k)];
    if (own < 0) own = groups++;
    k = own;
  }
  return of;
}

/// Joins modes that no gap between draws separates; returns the solution number of each mode.
std::vector<int> connected(const Draws& draws, const std::vector<int>& of, int groups) {
  const auto modes = static_cast<std::size_t>(groups);
  const Metric metric(covariance_within(draws, of, groups));
  const std::size_t step = std::max<std::size_t>(1, of.size() / kCompared);
  std::vector<VectorXd> points;
  std::vector<std::size_t> mode;
  for (std::size_t i = 0; i < of.size(); i += step) {
    points.emplace_back(metric.scaled(draws.z.col(static_cast<Index>(i))));
    mode.push_back(static_cast<std::size_t>(of[i]));
  }
  // Distance from each draw to the nearest other draw of its mode, and smallest distance between
  // draws of each pair of modes. Repeated draws (rejected proposals) are not neighbours.
  std::vector<double> nearest(points.size(), kInfinity);
  std::vector<std::vector<double>> gap(modes, std::vector<double>(modes, kInfinity));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (points[i] - points[j]).norm();
      if (mode[i] != mode[j]) {
        double& least = gap[std::max(mode[i], mode[j])][std::min(mode[i], mode[j])];
        least = std::min(least, distance);
      } else if (distance > 0.0) {
        nearest[i] = std::min(nearest[i], distance);
        nearest[j] = std::min(nearest[j], distance);
      }
    }
  std::vector<double> reach(modes, 0.0);
  for (std::size_t k = 0; k < modes; ++k) {
    std::vector<double> own;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (mode[i] == k && std::isfinite(nearest[i])) own.push_back(nearest[i]);
    std::ranges::sort(own);
    if (!own.empty()) reach[k] = kGap * quantile(own, kOfNeighbours);
  }
  std::vector<int> solution(modes);
  std::iota(solution.begin(), solution.end(), 0);
  for (std::size_t a = 0; a < modes; ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (gap[a][b] <= std::max(reach[a], reach[b])) {
        const int from = solution[a], to = solution[b];
        std::ranges::replace(solution, from, to);
      }
  return solution;
}

}  // namespace

SeparateSolutions separate_solutions(const Posterior& posterior, int model) {
  SeparateSolutions out;
  if (static_cast<std::size_t>(model) >= posterior.found.size() ||
      posterior.found[static_cast<std::size_t>(model)].modes.size() < 2)
    return out;
  const Draws draws = draws_of_model(posterior, model);
  if (draws.log_posterior.empty()) return out;
  int groups = 0;
  std::vector<int> of = nearest_modes(posterior, model, draws, groups);
  const std::vector<int> group = connected(draws, of, groups);
  for (int& k : of) k = group[static_cast<std::size_t>(k)];
  const auto all = static_cast<double>(of.size());
  for (int k = 0; k < groups; ++k) {
    const auto count = static_cast<double>(std::ranges::count(of, k));
    if (count == 0.0) continue;
    Solution solution{.probability = count / all, .chi_square = kNaN};
    inference::ChainsOf indicator;
    std::size_t best = 0;
    double most = -kInfinity;
    for (std::size_t c = 0; c + 1 < draws.of_chain.size(); ++c) {
      indicator.emplace_back();
      for (std::size_t i = draws.of_chain[c]; i < draws.of_chain[c + 1]; ++i) {
        indicator.back().push_back(of[i] == k ? 1.0 : 0.0);
        if (of[i] != k) continue;
        if (draws.log_posterior[i] > most) {
          most = draws.log_posterior[i];
          best = i;
        }
      }
    }
    if (solution.probability < kWorthListing) continue;
    solution.mcse = inference::mcse_mean(indicator);
    for (Index p = 0; p < draws.z.rows(); ++p) {
      const inference::Prior& prior = posterior.space->prior(model, static_cast<int>(p));
      inference::ChainsOf chains;
      for (std::size_t c = 0; c + 1 < draws.of_chain.size(); ++c) {
        chains.emplace_back();
        for (std::size_t i = draws.of_chain[c]; i < draws.of_chain[c + 1]; ++i)
          if (of[i] == k)
            chains.back().push_back(prior.from_standard_normal(draws.z(p, static_cast<Index>(i))));
      }
      std::erase_if(chains, [](const std::vector<double>& chain) { return chain.empty(); });
      solution.parameters.push_back(marginal(chains));
      solution.best.push_back(prior.from_standard_normal(draws.z(p, static_cast<Index>(best))));
    }
    out.list.push_back(std::move(solution));
  }
  if (out.list.size() < 2) return {};
  out.covariance_within = covariance_within(draws, of, groups);
  std::ranges::stable_sort(out.list, std::ranges::greater{}, &Solution::probability);
  return out;
}

}  // namespace wheeltap::identification
