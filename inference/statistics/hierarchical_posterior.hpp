// Hierarchical model of one quantity in several groups of data: common centre, standard deviation
// between groups, and prediction for a further group.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace wheeltap::inference {

/// Normal likelihood of the quantity θ_j of one group, without the prior:
///
///   ln L_j(θ) = c - ½ ((θ - mean) / sd)²;   sd = ∞ for data without information.
struct GroupEstimate {
  double mean = 0.0;
  double sd = 1.0;
};

/// A univariate mixture of normals.
class LineMixture {
 public:
  struct Component {
    double weight, mean, sd;  ///< weights sum to 1; sd > 0
  };

  explicit LineMixture(std::vector<Component> components) : components_(std::move(components)) {}

  [[nodiscard]] double cdf(double x) const;
  /// The quantile x with cdf(x) = p for p in (0, 1), by bisection to 1e-12 of the mixture's width.
  [[nodiscard]] double quantile(double p) const;
  /// Expectation of f(x) for a smooth function f, by quadrature with 29 points per component.
  [[nodiscard]] double expectation(const std::function<double(double)>& f) const;
  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

 private:
  std::vector<Component> components_;
};

struct HierarchicalOptions {
  double centre_mean = 0.0;  ///< mean of the normal prior of the centre
  double centre_sd = 1.0;
  double largest_scatter = 1.0;  ///< upper limit T of the standard deviation τ between groups
};

/// The posterior of
///
///   θ_j ~ N(μ, τ²),  data of group j ~ N(θ_j, s_j²),  μ ~ N(m₀, v₀),
///   p(τ) = 1 / ((λ + τ) ln(1 + T/λ)) on [0, T],  λ² the harmonic mean of the s_j²
///
/// (normal hierarchical model of Gelman et al. 2013, Bayesian Data Analysis, section 5.4; Sedehi,
/// Papadimitriou & Katafygiotis 2019 for windows of a record). The prior of τ is flat below the
/// error λ of a group, because the data cannot resolve a smaller τ. Above λ, the prior density is
/// proportional to 1/τ. Suppose that the means of the groups differ by more than their errors
/// explain. The credible interval of the centre is then that of Student's t with n - 1 degrees of
/// freedom. The coverage of this interval is exact for any n. Like the uniform shrinkage prior
/// (Daniels 1999), the prior depends on the errors and not on the means.
///
/// μ is integrated in closed form for every τ. τ is integrated by the midpoint rule in ln(λ + τ);
/// the prior of ln(λ + τ) is flat. The integration error is 1e-6 of the widths of the
/// distributions.
struct HierarchicalPosterior {
  LineMixture centre;  ///< posterior of the centre μ, the limit for infinitely many groups
  LineMixture group;   ///< prediction of θ of a further group: N(μ, τ²)
  /// Prediction of the estimate that a further group with the error λ would give: N(μ, τ² + λ²).
  LineMixture estimate;
  std::vector<double> scatter, weight;  ///< quadrature nodes τ and their probabilities
  double own_error = 0.0;               ///< standard error λ of a group
  int groups = 0;                       ///< number of groups with information
};

/// Throws std::invalid_argument for an sd <= 0, options that are not positive, or fewer than two
/// groups with information.
[[nodiscard]] HierarchicalPosterior hierarchical_posterior(std::span<const GroupEstimate> groups,
                                                           const HierarchicalOptions& options = {});

/// Ratio √(χ² / (n - 1)) of the scatter of the groups' means to their standard errors (Birge 1932),
/// with χ² = Σ ((mean_j - m) / sd_j)² about the weighted mean m. Also gives the probability that
/// errors alone cause a larger ratio.
struct BirgeRatio {
  double ratio = 1.0;
  double p_value = 1.0;  ///< probability that χ² with n - 1 degrees of freedom is larger
};
[[nodiscard]] BirgeRatio birge_ratio(std::span<const GroupEstimate> groups);

}  // namespace wheeltap::inference
