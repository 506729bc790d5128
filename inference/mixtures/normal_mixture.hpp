// Mixtures of multivariate normals (or Student's t), fitted to samples: proposals that know the
// shape of a posterior.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "base/random.hpp"

namespace wheeltap::inference {

/// q(z) = Σ_k w_k N(z; μ_k, L_k L_kᵀ), or with Student t tails,
///
///   t_ν(z; μ, L) = Γ((ν+d)/2) / (Γ(ν/2) (νπ)^{d/2} |L|) · (1 + |L⁻¹(z-μ)|²/ν)^{-(ν+d)/2}.
///
/// Immutable once made, so that threads may share one.
class NormalMixture {
 public:
  struct Component {
    double weight;           ///< > 0; normalised over the mixture
    Eigen::VectorXd mean;    ///< d
    Eigen::MatrixXd factor;  ///< lower Cholesky factor L of the covariance (scale matrix), d × d
  };

  enum class Criterion { bic, aic };

  struct FitOptions {
    int max_components = 20;
    /// Decides the number of components: -ln likelihood + ½ · parameters · ln n (BIC: prefers few),
    /// or
    /// + parameters (AIC: prefers a close fit).
    Criterion criterion = Criterion::bic;
    /// Weight of an added component N(0, defensive_sd² I), which covers the tails that the samples
    /// did not reach (Hesterberg 1995). With sd 1 it is the prior of standard normal coordinates,
    /// so that no importance weight exceeds max likelihood / (weight · evidence).
    double defensive_weight = 0.02;
    double defensive_sd = 1.0;
    /// ν of the components' tails; ∞ is normal. The fit itself is by normals.
    double degrees_of_freedom = std::numeric_limits<double>::infinity();
    int max_iterations = 200;  ///< of EM, in the final polish
    double tolerance = 1e-7;   ///< of it, in the mean log density of a sample
  };

  /// Throws std::invalid_argument where the components are none or of different dimensions, a
  /// weight is not positive, a factor's diagonal is not positive, or ν <= 0.
  explicit NormalMixture(std::vector<Component> components,
                         double degrees_of_freedom = std::numeric_limits<double>::infinity());

  /// Of another mixture's components, whose weights are taken as they are: the same bits. Throws as
  /// the constructor does.
  [[nodiscard]] static NormalMixture restored(std::vector<Component> components,
                                              double degrees_of_freedom);

  /// N(0, sd² I) in d dimensions.
  [[nodiscard]] static NormalMixture standard(int dimension, double sd = 1.0);

  /// Fits by expectation-maximisation from k-means++ centres (Arthur & Vassilvitskii 2007),
  /// starting with the most components and merging the pair that loses least (Runnalls 2007, IEEE
  /// Trans. AES 43:989) until one is left; the criterion picks among the sizes met on the way, as
  /// in Figueiredo & Jain 2002 and AutoMix. Repeated samples (rejections of a chain) keep their
  /// mass but count once towards the number a component needs, so that none collapses onto one of
  /// them.
  ///
  /// `samples` is n × d. Throws std::invalid_argument for no sample, a sample that is not finite,
  /// or options out of range. With too few samples for a covariance, one broad component is
  /// returned.
  [[nodiscard]] static NormalMixture fit(const Eigen::MatrixXd& samples, const FitOptions& options,
                                         base::Random& random);
  // Separate from the above because GCC will not take {} for a nested aggregate's default.
  [[nodiscard]] static NormalMixture fit(const Eigen::MatrixXd& samples, base::Random& random);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] int size() const { return static_cast<int>(components_.size()); }
  [[nodiscard]] const Component& operator[](int k) const {
    return components_[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] double degrees_of_freedom() const { return nu_; }

  /// ln q(z); -∞ where z is not finite or so remote that q underflows even on the log scale.
  [[nodiscard]] double log_density(std::span<const double> z) const;
  /// ln w_k + ln of component k's density at z, for every k: `out` has size() entries.
  void component_log_densities(std::span<const double> z, std::span<double> out) const;

  void sample(base::Random& random, std::span<double> out) const;
  /// A component, with the mixture's probabilities.
  [[nodiscard]] int sample_component(base::Random& random) const;

  /// u = L_k⁻¹ (z - μ_k), and back; the Jacobian |dz/du| is e^{log_determinant(k)}. Between
  /// components of two models these make the affine transport of Green 2003.
  void standardise(int k, std::span<const double> z, std::span<double> u) const;
  void unstandardise(int k, std::span<const double> u, std::span<double> z) const;
  [[nodiscard]] double log_determinant(int k) const;

 private:
  NormalMixture(std::vector<Component> components, double degrees_of_freedom, bool normalised);

  int dimension_ = 0;
  double nu_ = std::numeric_limits<double>::infinity();
  std::vector<Component> components_;
  std::vector<double> cumulative_;
  std::vector<double> packed_;  ///< see packed_mixture.hpp
};

}  // namespace wheeltap::inference
