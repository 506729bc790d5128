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
/// Mean shape · scale.
struct Gamma {
  double shape, scale;
};
/// Scaled to [lower, upper].
struct Beta {
  double a, b, lower = 0.0, upper = 1.0;
};
/// N(mean, sd²) cut to [lower, upper], either of which may be infinite.
struct TruncatedNormal {
  double mean, sd, lower, upper;
};
/// 1/x ~ Gamma(shape, 1/scale): p(x) ∝ x^(-shape-1) exp(-scale/x). Its mean is infinite for
/// shape <= 1, its standard deviation for shape <= 2.
struct InverseGamma {
  double shape, scale;
};
/// (x - location)/scale is Student's t of `nu` degrees of freedom, which need not be whole.
/// Cauchy's for nu = 1. The mean does not exist for nu <= 1 (the location is given in its place);
/// the standard deviation is infinite for nu <= 2.
struct StudentT {
  double nu, location, scale;
};

/// A prior of your own: a continuous density on an interval, positive inside. `check_prior` of
/// self_tests.hpp tries whether its functions belong together. It is shared between threads and
/// says the same at every call.
class Distribution {
 public:
  virtual ~Distribution() = default;

  /// ln p(x), normalised, for lower() < x < upper().
  [[nodiscard]] virtual double log_density(double x) const = 0;
  /// F(x) and 1 - F(x), each with a small *relative* error: where one is near 1 the other is not
  /// 1 less it.
  struct Tails {
    double below, above;
  };
  [[nodiscard]] virtual Tails tails(double x) const = 0;
  /// x of F(x) = t.below. The default searches `tails` for it, which costs some sixty calls.
  [[nodiscard]] virtual double quantile(Tails t) const;
  /// The ends of the support, possibly ±∞.
  [[nodiscard]] virtual double lower() const = 0;
  [[nodiscard]] virtual double upper() const = 0;
  /// As findings and files name it, with its numbers.
  [[nodiscard]] virtual std::string describe() const = 0;
};
struct OwnPrior {
  std::shared_ptr<const Distribution> distribution;
};

/// One prior. All inference runs in the *standard normal coordinate* z of each parameter,
///
///   z = Φ⁻¹(F(x)),   x = F⁻¹(Φ(z)),
///
/// F being the prior's distribution function, so that a priori z ~ N(0, 1) whatever the family, the
/// unit or the bounds (the isoprobabilistic transform of reliability analysis: Der Kiureghian & Liu
/// 1986). Proposals then need no bounds, birth from the prior is a standard normal draw, and a
/// problem posed in millimetres is the same problem.
class Prior {
 public:
  using Family = std::variant<Uniform, LogUniform, Normal, LogNormal, HalfNormal, Gamma, Beta,
                              TruncatedNormal, InverseGamma, StudentT, OwnPrior>;

  /// Throws std::invalid_argument, naming family, value and bound, where the density would be
  /// improper (inverted or infinite bounds, scale <= 0, NaN), or no distribution is given.
  Prior(Family family);  // NOLINT(google-explicit-constructor): a family *is* a prior
  template <class F>
  requires(std::constructible_from<Family, F> && !std::same_as<F, Family> &&
           !std::same_as<F, Prior>) Prior(F family)
      : Prior(Family(family)) {}  // NOLINT(google-explicit-constructor)

  /// ln p(x), normalised; -∞ outside the support.
  [[nodiscard]] double log_density(double x) const;
  /// x = F⁻¹(Φ(z)), accurate in both tails, always inside the closed support.
  [[nodiscard]] double from_standard_normal(double z) const;
  /// z = Φ⁻¹(F(x)); ±∞ at or outside the ends of the support.
  [[nodiscard]] double to_standard_normal(double x) const;
  /// dx/dz = φ(z) / p(x(z)), in the unit of x and never negative; 0 where x(z) has reached an end
  /// of the support in floating point.
  [[nodiscard]] double slope(double z) const;
  [[nodiscard]] double lower() const;  ///< ends of the support, possibly ±∞
  [[nodiscard]] double upper() const;
  [[nodiscard]] double mean() const;
  [[nodiscard]] double sd() const;
  [[nodiscard]] const Family& family() const { return family_; }
  /// As in a case file, e.g. "uniform [0, 100]".
  [[nodiscard]] std::string describe() const;

 private:
  Family family_;
  double log_normaliser_ = 0.0;
};

}  // namespace wheeltap::inference
