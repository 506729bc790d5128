// One climb to a mode of one model's posterior, and what is measured of the mode when it is there.
#pragma once

#include <functional>
#include <limits>
#include <utility>
#include <vector>
#include "base/eigen.hpp"

#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// ln π(z) of labelled vectors, on which it is symmetric; -∞ beyond |z_i| = 8.3, the prior's
/// support but for a share of 1e-16. Its calls are counted.
class Surface {
 public:
  Surface(const Problem& problem, int model) : posterior_(problem, model) {}

  double operator()(const Eigen::VectorXd& z);
  /// One value a column: likelihoods that advance together are cheaper than one by one. Of values
  /// below `level` that alone needs to be known: they may be -∞.
  Eigen::VectorXd values(const Eigen::MatrixXd& zs,
                         double level = -std::numeric_limits<double>::infinity());
  /// ∇ ln π(z); false where the likelihood has none.
  bool gradient(const Eigen::VectorXd& z, Eigen::VectorXd& g);
  /// ∇ ln π(z) and a positive definite stand-in for -∇² ln π(z), by differences over dz; false
  /// where the likelihood has none (Likelihood::gauss_newton), or none there.
  bool gauss_newton(const Eigen::VectorXd& z, const Eigen::VectorXd& dz, Eigen::VectorXd& g,
                    Eigen::MatrixXd& information);
  void draw_prior(base::Random& random, Eigen::VectorXd& z);
  /// Components in order.
  [[nodiscard]] std::vector<double> ordered(const Eigen::VectorXd& z);
  [[nodiscard]] Eigen::Index dimension() const { return posterior_.dimension(); }
  [[nodiscard]] long evaluations() const { return posterior_.evaluations(); }
  /// All that one call leaves for the next, for another rank's surface of the same problem.
  template <class Parcel>
  void carry(Parcel& parcel) {
    posterior_.carry(parcel);
    parcel(offers_gradient_);
  }
  /// Asked before each likelihood; true: the climb that asks ends where it is.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

 private:
  ModelPosterior posterior_;
  std::vector<double> ordered_, batch_;
  std::vector<Eigen::Index> places_;  ///< of the batch among its columns
  std::vector<ModelPosterior::Value> values_;
  bool offers_gradient_ = true;  ///< until it does not
  std::function<bool()> stop_;
};

/// A mode, ready for use.
struct KnownMode {
  Eigen::VectorXd z;
  double value = 0.0;
  Eigen::MatrixXd covariance, precision;
};

/// Where a climb ended.
struct ClimbEnd {
  Eigen::VectorXd z;
  double value = -std::numeric_limits<double>::infinity();
  Eigen::MatrixXd inverse_hessian{};  ///< what the climb knows of it
  int known = -1;                     ///< index of the mode it arrived at
  bool possible = false;              ///< the start was
  double way = 0.0;                   ///< length of its path, in standard deviations of the prior
  long points = 0;  ///< of the path at which it evaluated ln π, without the start
};

/// From `start` to a mode: by a few Newton steps with the curvature of the nearest known one where
/// they do, else by Gauss-Newton steps where the likelihood offers them, or BFGS (mode_search.hpp).
/// Between two points of its path a climb sees nothing: it may step over a narrow mode to which
/// steepest ascent would lead. `way / points` is how far these points are apart.
///
/// Its first differences are those of a draw of the prior, which from a start near a mode, a
/// thousandth of the prior wide, point nowhere; `fine` ones are made smaller until the widths that
/// they measure settle.
[[nodiscard]] ClimbEnd climb(Surface& f, const Eigen::VectorXd& start,
                             const std::vector<KnownMode>& known, bool fine = false);

/// The Hessian by differences over steps that lower ln π by about a twentieth of a nat, made
/// positive definite: no direction is much wider than the prior.
[[nodiscard]] KnownMode measure(Surface& f, const ClimbEnd& end);

/// Distance from a mode in its own standard deviations, squared.
[[nodiscard]] double square_distance(const KnownMode& mode, const Eigen::VectorXd& z);

}  // namespace wheeltap::inference
