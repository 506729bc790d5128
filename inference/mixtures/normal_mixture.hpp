// Mixtures of multivariate normal (or Student's t) distributions, fitted to samples for use as
// proposals.
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
/// A mixture is immutable, so that threads may share one object.
class NormalMixture {
 public:
  struct Component {
    double weight;           ///< weight > 0; normalised over the mixture
    Eigen::VectorXd mean;    ///< d
    Eigen::MatrixXd factor;  ///< lower Cholesky factor L of the covariance (scale matrix), d × d
  };

  enum class Criterion { bic, aic };

  struct FitOptions {
    int max_components = 20;
    /// Criterion that the number of components minimises: BIC is -ln likelihood + ½ · parameters ·
    /// ln n (fewer components), AIC is -ln likelihood + parameters (closer fit).
    Criterion criterion = Criterion::bic;
    /// Weight of an added component N(0, defensive_sd² I), which covers tails without samples
    /// (Hesterberg 1995). With defensive_sd = 1, this component equals the prior in standard normal
    /// coordinates. No importance weight then exceeds max likelihood / (weight · evidence).
    double defensive_weight = 0.02;
    double defensive_sd = 1.0;
    /// Degrees of freedom ν of the components; ∞: normal components. The fit itself assumes normal
    /// components.
    double degrees_of_freedom = std::numeric_limits<double>::infinity();
    int max_iterations = 200;  ///< largest number of final EM iterations
    double tolerance = 1e-7;   ///< tolerance of the EM iterations, in mean log density per sample
  };

  /// Throws std::invalid_argument if there are no components, dimensions differ, a weight or an
  /// entry of a factor's diagonal is not positive, or ν <= 0.
  explicit NormalMixture(std::vector<Component> components,
                         double degrees_of_freedom = std::numeric_limits<double>::infinity());

  /// Restores a mixture from the components of another mixture bit for bit, without normalising the
  /// weights. Throws the exceptions of the constructor.
  [[nodiscard]] static NormalMixture restored(std::vector<Component> components,
                                              double degrees_of_freedom);

  /// N(0, sd² I) in d dimensions.
  [[nodiscard]] static NormalMixture standard(int dimension, double sd = 1.0);

  /// Fits by expectation-maximisation from k-means++ centres (Arthur & Vassilvitskii 2007). The fit
  /// starts with the largest number of components and repeatedly merges the pair of components with
  /// the smallest loss (Runnalls 2007, IEEE Trans. AES 43:989). The criterion selects one of the
  /// mixtures that this sequence of merges produces (Figueiredo & Jain 2002; AutoMix). Repeated
  /// samples (rejections of a chain) keep their weight, but count only once for the minimum number
  /// of samples per component. No component can therefore collapse onto a repeated sample.
  ///
  /// `samples` is n × d. Throws std::invalid_argument for an empty `samples`, a sample that is not
  /// finite, or options out of range. The result has one broad component if the samples are too few
  /// for a covariance.
  [[nodiscard]] static NormalMixture fit(const Eigen::MatrixXd& samples, const FitOptions& options,
                                         base::Random& random);
  // A separate overload, because GCC rejects {} as the default argument of a nested aggregate.
  [[nodiscard]] static NormalMixture fit(const Eigen::MatrixXd& samples, base::Random& random);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] int size() const { return static_cast<int>(components_.size()); }
  [[nodiscard]] const Component& operator[](int k) const {
    return components_[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] double degrees_of_freedom() const { return nu_; }

  /// Log density ln q(z). The value is -∞ if z is not finite, or if z is so far from all components
  /// that even ln q is not representable.
  [[nodiscard]] double log_density(std::span<const double> z) const;
  /// Writes ln w_k + ln p_k(z) to out[k] for every component k with weight w_k and density p_k.
  /// `out` has size() entries.
  void component_log_densities(std::span<const double> z, std::span<double> out) const;

  void sample(base::Random& random, std::span<double> out) const;
  /// Draws a component index with probabilities equal to the mixture's weights.
  [[nodiscard]] int sample_component(base::Random& random) const;

  /// Computes u = L_k⁻¹ (z - μ_k); the next function computes z from u. The Jacobian |dz/du| is
  /// e^{log_determinant(k)}. `standardise` with a component of one model and `unstandardise` with a
  /// component of another model together form the affine transport of Green 2003.
  void standardise(int k, std::span<const double> z, std::span<double> u) const;
  void unstandardise(int k, std::span<const double> u, std::span<double> z) const;
  [[nodiscard]] double log_determinant(int k) const;

 private:
  NormalMixture(std::vector<Component> components, double degrees_of_freedom, bool normalised);

  int dimension_ = 0;
  double nu_ = std::numeric_limits<double>::infinity();
  std::vector<Component> components_;
  std::vector<double> cumulative_;
  std::vector<double> packed_;  ///< components packed for vector instructions (packed_mixture.hpp)
};

}  // namespace wheeltap::inference
