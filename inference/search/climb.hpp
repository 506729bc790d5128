// Local optimisation (`climb`) to a posterior mode of one model, and the Hessian at this mode.
#pragma once

#include <functional>
#include <limits>
#include <utility>
#include <vector>
#include "base/eigen.hpp"

#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// ln π(z) for components in any order: a permutation of the components does not change ln π(z). ln
/// π is -∞ for |z_i| > 8.3, a range with a prior probability of 1e-16. Surface counts its
/// likelihood evaluations.
class Surface {
 public:
  Surface(const Problem& problem, int model) : posterior_(problem, model) {}

  double operator()(const Eigen::VectorXd& z);
  /// ln π of each column; one call for several columns is faster. Values below `level` may be -∞.
  Eigen::VectorXd values(const Eigen::MatrixXd& zs,
                         double level = -std::numeric_limits<double>::infinity());
  /// Computes ∇ ln π(z); returns false if the likelihood has no gradient at z.
  bool gradient(const Eigen::VectorXd& z, Eigen::VectorXd& g);
  /// ∇ ln π(z) and a positive definite approximation of -∇² ln π(z), by finite differences with the
  /// steps dz. Returns false if the likelihood has no Gauss-Newton approximation at z
  /// (Likelihood::gauss_newton).
  bool gauss_newton(const Eigen::VectorXd& z, const Eigen::VectorXd& dz, Eigen::VectorXd& g,
                    Eigen::MatrixXd& information);
  void draw_prior(base::Random& random, Eigen::VectorXd& z);
  /// Returns z with its exchangeable components sorted.
  [[nodiscard]] std::vector<double> ordered(const Eigen::VectorXd& z);
  [[nodiscard]] Eigen::Index dimension() const { return posterior_.dimension(); }
  [[nodiscard]] long evaluations() const { return posterior_.evaluations(); }
  /// Returns Likelihood::has_exact_derivatives.
  [[nodiscard]] bool has_exact_derivatives() const { return posterior_.has_exact_derivatives(); }
  /// Number of likelihood evaluations saved by exact derivatives, compared with central
  /// differences.
  [[nodiscard]] long saved() const { return saved_; }
  /// Packs or unpacks the state between two calls, for the Surface on another rank.
  template <class Parcel>
  void carry(Parcel& parcel) {
    posterior_.carry(parcel);
    parcel(gradients_, refusals_, saved_);
  }
  /// Sets a callback that is called before each likelihood evaluation; if the callback returns
  /// true, the current optimisation ends.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  [[nodiscard]] bool stopped() const { return stop_ && stop_(); }

 private:
  ModelPosterior posterior_;
  std::vector<double> ordered_, batch_;
  std::vector<Eigen::Index> places_;  ///< column of each batch entry
  std::vector<ModelPosterior::Value> values_;
  long gradients_ = 0, refusals_ = 0;  ///< number of gradients; number of points without a gradient
  long saved_ = 0;
  std::function<bool()> stop_;
};

/// A posterior mode with the quantities that local optimisations use.
struct KnownMode {
  Eigen::VectorXd z;
  double value = 0.0;
  Eigen::MatrixXd covariance, precision;
};

/// Result of a local optimisation.
struct ClimbEnd {
  Eigen::VectorXd z;
  double value = -std::numeric_limits<double>::infinity();
  Eigen::MatrixXd inverse_hessian{};  ///< estimated during the optimisation
  int known = -1;                     ///< index of the known posterior mode that was reached
  bool possible = false;              ///< true if the posterior density at the start is positive
  double way = 0.0;                   ///< length of the path, in standard deviations of the prior
  long points = 0;                    ///< number of points of the path, without the start
};

/// Optimises from `start` to a posterior mode. The function first tries a few Newton steps with the
/// curvature of the nearest known posterior mode. Then it uses Gauss-Newton steps if the likelihood
/// supports them, and BFGS otherwise (mode_search.hpp). Between two points, the path may jump over
/// a narrow mode to which steepest ascent would lead. The mean distance between consecutive points
/// of the path is `way / points`.
///
/// The default difference steps for the gradient are suitable for a start drawn from the prior.
/// Near a posterior mode whose width is a thousandth of the width of the prior, the default steps
/// give a wrong direction of the gradient. If `fine` is true, the steps are reduced until the
/// widths of the mode converge.
[[nodiscard]] ClimbEnd climb(Surface& f, const Eigen::VectorXd& start,
                             const std::vector<KnownMode>& known, bool fine = false);

/// Computes the Hessian at a posterior mode by differences with steps that lower ln π by about a
/// twentieth of a nat. The Hessian is made positive definite, so that the normal approximation is
/// not much wider than the prior in any direction. Exact derivatives, if the likelihood has them,
/// replace second differences.
[[nodiscard]] KnownMode measure(Surface& f, const ClimbEnd& end);

/// Squared distance of z from a mode, in standard deviations of its normal approximation.
[[nodiscard]] double square_distance(const KnownMode& mode, const Eigen::VectorXd& z);

}  // namespace wheeltap::inference
