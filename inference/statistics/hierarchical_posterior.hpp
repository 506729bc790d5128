// One quantity seen in several groups of data: what the groups have in common, how far they
// scatter, and what a further group would show.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace wheeltap::inference {

/// What the data of one group say of its own value θ_j, whatever the prior:
///
///   ln L_j(θ) = c - ½ ((θ - mean) / sd)²;   sd = ∞ where they say nothing.
struct GroupEstimate {
  double mean = 0.0;
  double sd = 1.0;
};

/// A mixture of normals on the line.
class LineMixture {
 public:
  struct Component {
    double weight, mean, sd;  ///< weights sum to 1; sd > 0
  };

  explicit LineMixture(std::vector<Component> components) : components_(std::move(components)) {}

  [[nodiscard]] double cdf(double x) const;
  /// cdf(x) = p in (0, 1), by bisection to a relative 1e-12 of the mixture's width.
  [[nodiscard]] double quantile(double p) const;
  /// E f(x) of a smooth f, by quadrature of 29 points a component.
  [[nodiscard]] double expectation(const std::function<double(double)>& f) const;
  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

 private:
  std::vector<Component> components_;
};

struct HierarchicalOptions {
  double centre_mean = 0.0;  ///< prior of the centre: normal
  double centre_sd = 1.0;
  double largest_scatter = 1.0;  ///< T below
};

/// The posterior of
///
///   θ_j ~ N(μ, τ²),  data of group j ~ N(θ_j, s_j²),  μ ~ N(m₀, v₀),
///   p(τ) = 1 / ((λ + τ) ln(1 + T/λ)) on [0, T],  λ² the harmonic mean of the s_j²
///
/// (the normal hierarchical model of Gelman et al. 2013, Bayesian Data Analysis, section 5.4;
/// Sedehi, Papadimitriou & Katafygiotis 2019 for windows of a record). The prior of τ is flat below
/// a group's own error, where no data can tell, and 1/τ above it, so that where groups scatter by
/// more than their errors the centre has the interval of Student's t with n - 1 degrees of freedom,
/// which holds what it says for any n. It uses the sizes of the errors, as the uniform shrinkage
/// prior does (Daniels 1999), never the means.
///
/// μ is integrated in closed form for every τ, τ by the midpoint rule in ln(λ + τ), in which its
/// prior is flat: exact but for 1e-6 of the widths.
struct HierarchicalPosterior {
  LineMixture centre;  ///< μ: what ever more groups tend to
  LineMixture group;   ///< θ of a further group: N(μ, τ²)
  /// The mean that a further group's data would have, their error being the λ of the others:
  /// N(μ, τ² + λ²).
  LineMixture estimate;
  std::vector<double> scatter, weight;  ///< τ and its probability, nodes of the quadrature
  double own_error = 0.0;               ///< λ
  int groups = 0;                       ///< that say something
};

/// Throws std::invalid_argument for an sd <= 0, options that are not positive, or fewer than two
/// groups that say something.
[[nodiscard]] HierarchicalPosterior hierarchical_posterior(std::span<const GroupEstimate> groups,
                                                           const HierarchicalOptions& options = {});

/// How much more groups scatter than their errors say, and how likely errors alone would do so:
/// √(χ² / (n - 1)), χ² = Σ ((mean_j - m) / sd_j)² about the weighted mean m (Birge 1932).
struct BirgeRatio {
  double ratio = 1.0;
  double p_value = 1.0;  ///< P(χ² with n - 1 degrees of freedom is larger)
};
[[nodiscard]] BirgeRatio birge_ratio(std::span<const GroupEstimate> groups);

}  // namespace wheeltap::inference
