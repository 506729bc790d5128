// Proper, normalised prior densities of one real parameter.
#pragma once

#include <concepts>
#include <memory>
#include <string>
#include <variant>

namespace wheeltap::inference {

struct Uniform {
  double lower, upper;
};
/// p(x) ∝ 1/x, 0 < lower < upper.
struct LogUniform {
  double lower, upper;
};
struct Normal {
  double mean, sd;
};
/// ln x ~ N(mu, sigma²).
struct LogNormal {
  double mu, sigma;
};
/// |N(0, sd²)|.
struct HalfNormal {
  double sd;
};
/// Gamma distribution with the mean shape · scale.
struct Gamma {
  double shape, scale;
};
/// Beta distribution, scaled to [lower, upper].
struct Beta {
  double a, b, lower = 0.0, upper = 1.0;
};
/// N(mean, sd²) truncated to [lower, upper], either of which may be infinite.
struct TruncatedNormal {
  double mean, sd, lower, upper;
};
/// 1/x ~ Gamma(shape, 1/scale): p(x) ∝ x^(-shape-1) exp(-scale/x). The mean is infinite for shape
/// <= 1, the standard deviation for shape <= 2.
struct InverseGamma {
  double shape, scale;
};
/// (x - location)/scale has Student's t distribution with `nu` degrees of freedom; `nu` need not be
/// an integer. nu = 1 gives the Cauchy distribution. The mean does not exist for nu <= 1 (mean()
/// returns the location); the standard deviation is infinite for nu <= 2.
struct StudentT {
  double nu, location, scale;
};

/// Base class of user-defined priors: a continuous density on an interval, positive inside.
/// `check_prior` of self_tests.hpp tests whether the functions are consistent. Threads share one
/// object, so its functions must be pure.
class Distribution {
 public:
  virtual ~Distribution() = default;

  /// ln p(x), normalised, for lower() < x < upper().
  [[nodiscard]] virtual double log_density(double x) const = 0;
  /// The two tail probabilities F(x) and 1 - F(x), each with a small *relative* error. Computing
  /// one tail probability as 1 minus the other would lose accuracy in the tails.
  struct Tails {
    double below, above;
  };
  [[nodiscard]] virtual Tails tails(double x) const = 0;
  /// The quantile x with F(x) = t.below. The default implementation finds x by about sixty calls of
  /// `tails`.
  [[nodiscard]] virtual double quantile(Tails t) const;
  /// Bounds of the support, possibly ±∞.
  [[nodiscard]] virtual double lower() const = 0;
  [[nodiscard]] virtual double upper() const = 0;
  /// Name of the distribution with its parameters, for results and files.
  [[nodiscard]] virtual std::string describe() const = 0;
};
struct OwnPrior {
  std::shared_ptr<const Distribution> distribution;
};

/// The prior of one parameter. All inference uses the *standard normal coordinate* z of each
/// parameter,
///
///   z = Φ⁻¹(F(x)),   x = F⁻¹(Φ(z)).
///
/// F is the distribution function of the prior. A priori, z ~ N(0, 1) for every family, unit and
/// bound (isoprobabilistic transform of reliability analysis: Der Kiureghian & Liu 1986).
/// Proposals then need no bounds, a birth from the prior is a standard normal draw, and results do
/// not depend on the units of parameters.
class Prior {
 public:
  using Family = std::variant<Uniform, LogUniform, Normal, LogNormal, HalfNormal, Gamma, Beta,
                              TruncatedNormal, InverseGamma, StudentT, OwnPrior>;

  /// Throws std::invalid_argument, with the family, the value and the bound, if the density is
  /// improper (inverted or infinite bounds, scale <= 0, NaN), or the distribution is null.
  Prior(Family family);  // NOLINT(google-explicit-constructor): a family *is* a prior
  template <class F>
  requires(std::constructible_from<Family, F> && !std::same_as<F, Family> &&
           !std::same_as<F, Prior>) Prior(F family)
      : Prior(Family(family)) {}  // NOLINT(google-explicit-constructor)

  /// ln p(x), normalised; -∞ outside the support.
  [[nodiscard]] double log_density(double x) const;
  /// x = F⁻¹(Φ(z)), accurate in both tails, always inside the closed support.
  [[nodiscard]] double from_standard_normal(double z) const;
  /// z = Φ⁻¹(F(x)); ±∞ at or outside the bounds of the support.
  [[nodiscard]] double to_standard_normal(double x) const;
  /// dx/dz = φ(z) / p(x(z)) >= 0 in the unit of x. The result is 0 if x(z) is rounded to a bound of
  /// the support.
  [[nodiscard]] double slope(double z) const;
  [[nodiscard]] double lower() const;  ///< bounds of the support, possibly ±∞
  [[nodiscard]] double upper() const;
  [[nodiscard]] double mean() const;
  [[nodiscard]] double sd() const;
  [[nodiscard]] const Family& family() const { return family_; }
  /// Description of the prior in the form of a case file, e.g. "uniform [0, 100]".
  [[nodiscard]] std::string describe() const;

 private:
  Family family_;
  double log_normaliser_ = 0.0;
};

}  // namespace wheeltap::inference
