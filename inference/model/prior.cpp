#include "inference/model/prior.hpp"

#include <algorithm>
#include <bit>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

// No promotion to long double. A quantile that underflows is a bound of the support, not an error.
namespace bmp = boost::math::policies;
using Policy =
    bmp::policy<bmp::promote_double<false>, bmp::domain_error<bmp::ignore_error>,
                bmp::pole_error<bmp::ignore_error>, bmp::overflow_error<bmp::ignore_error>,
                bmp::underflow_error<bmp::ignore_error>, bmp::denorm_error<bmp::ignore_error>,
                bmp::evaluation_error<bmp::ignore_error>>;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

std::string list(std::initializer_list<double> values) {
  std::string text;
  for (const double x : values) text.append(text.empty() ? "[" : ", ").append(base::number(x));
  return text.append("]");
}

[[noreturn]] void refuse(const char* family, const char* name, double value, const char* bound) {
  throw std::invalid_argument(std::string(family) + " prior: " + name + " = " +
                              base::number(value) + ", must be " + bound);
}

void require_finite(const char* family, const char* name, double value) {
  if (!std::isfinite(value)) refuse(family, name, value, "finite");
}

void require_positive(const char* family, const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) refuse(family, name, value, "> 0 and finite");
}

void require_interval(const char* family, double lower, double upper) {
  require_finite(family, "lower", lower);
  require_finite(family, "upper", upper);
  if (!(lower < upper))
    refuse(family, "lower", lower, ("< upper = " + base::number(upper)).c_str());
  if (!std::isfinite(upper - lower)) refuse(family, "upper", upper, "within range of lower");
}

// Computes z from the lower and upper tail probabilities. The smaller probability is accurate.
double from_tails(double p, double q) {
  return p < q ? normal_quantile(p) : -normal_quantile(q);
}

// lower + width · Φ(z), computed from the nearer bound.
double interpolate(double lower, double upper, double z) {
  const double width = upper - lower;
  return z < 0.0 ? lower + width * normal_cdf(z) : upper - width * normal_cdf(-z);
}

// ln(a/b), even if the quotient overflows, as for a denormal b.
double log_quotient(double a, double b) {
  const double quotient = a / b;
  return std::isfinite(quotient) ? std::log(quotient) : std::log(a) - std::log(b);
}

double log_span(const LogUniform& f) {
  return log_quotient(f.upper, f.lower);
}

double clamp(double x, double lower, double upper) {
  return x < lower ? lower : (x > upper ? upper : x);
}

struct UnitQuantile {
  double t, rest;  // rest = 1 - t
};

// Computed from the nearer end of [0, 1], so that small distances from both ends are accurate.
UnitQuantile beta_quantile(const Beta& f, double z) {
  double rest = 0.0;
  const double t = z < 0.0 ? boost::math::ibeta_inv(f.a, f.b, normal_cdf(z), &rest, Policy{})
                           : boost::math::ibetac_inv(f.a, f.b, normal_cdf(-z), &rest, Policy{});
  return {t, rest};
}

/// N(0, 1) truncated to [a, b], reflected so that a + b <= 0. Most of the mass is then below 0,
/// where lower tail probabilities are accurate.
struct StandardTruncated {
  double a, b;
  bool reflected;

  explicit StandardTruncated(const TruncatedNormal& t)
      : a((t.lower - t.mean) / t.sd), b((t.upper - t.mean) / t.sd), reflected(a + b > 0.0) {
    if (reflected) {
      const double old_a = a;
      a = -b;
      b = -old_a;
    }
  }

  // True if the density is nearly exponential, e^{-m t}: on a short interval (relative error
  // (b-a)²/8) or a remote interval (relative error 1/b²), where differences of ln Φ cancel.
  [[nodiscard]] bool exponential() const { return b - a < 1e-5 || b < -1e4; }
  [[nodiscard]] double rate() const { return b - a < 1e-5 ? -0.5 * (a + b) : -b; }  // >= 0

  [[nodiscard]] double log_mass() const {
    if (!exponential()) return log_diff_exp(log_normal_cdf(b), log_normal_cdf(a));
    const double m = rate(), w = b - a;
    if (b - a < 1e-5) {
      const double top = -0.125 * (a + b) * (a + b) - kLogSqrt2Pi;  // at the midpoint
      return top + std::log(m * w < 1e-8 ? w : 2.0 * std::sinh(0.5 * m * w) / m);
    }
    return -0.5 * b * b - kLogSqrt2Pi + std::log(-std::expm1(-m * w) / m);
  }

  // Quantile from ln p and ln q, the tail probabilities relative to the whole mass.
  [[nodiscard]] double quantile(double p, double q) const {
    if (!exponential()) {
      // Φ(u) = q Φ(a) + p Φ(b), or Φ(-u) = q Φ(-a) + p Φ(-b) for the upper half
      const double log_p = std::log(p), log_q = std::log(q);
      const auto mixed = [&](double at_a, double at_b) {
        return std::fmin(0.0,
                         log_sum_exp(log_q + log_normal_cdf(at_a), log_p + log_normal_cdf(at_b)));
      };
      const double below = mixed(a, b);
      if (below < -std::numbers::ln2) return normal_quantile_of_log(below);
      return -normal_quantile_of_log(mixed(-a, -b));
    }
    const double m = rate(), w = b - a;
    if (m * w < 1e-8) return a + w * p;
    return b + std::log(p + q * std::exp(-m * w)) / m;
  }

  [[nodiscard]] double to_standard(double u) const {
    if (!exponential()) {
      const double log_a = log_normal_cdf(a), log_b = log_normal_cdf(b), log_u = log_normal_cdf(u);
      const double log_all = log_diff_exp(log_b, log_a);
      return from_tails(std::exp(log_diff_exp(log_u, log_a) - log_all),
                        std::exp(log_diff_exp(log_b, log_u) - log_all));
    }
    const double m = rate(), w = b - a;
    if (m * w < 1e-8) return from_tails((u - a) / w, (b - u) / w);
    const double all = -std::expm1(-m * w);
    return from_tails(std::exp(-m * (b - u)) * -std::expm1(-m * (u - a)) / all,
                      -std::expm1(-m * (b - u)) / all);
  }
};

// Student's t: P(|T| > t) = I_y(ν/2, ½) with y = ν / (ν + t²).
double student_upper_tail(double nu, double t) {
  const double u = t / std::sqrt(nu);
  const double y = 1.0 / (1.0 + u * u);
  if (y < 0.5) return 0.5 * boost::math::ibeta(0.5 * nu, 0.5, y, Policy{});
  return 0.5 * boost::math::ibetac(0.5, 0.5 * nu, u * u * y, Policy{});
}

// t > 0 with upper tail probability Φ(-z), z > 0. Near the centre, 1 - 2Φ(-z) = erf(z/√2) is
// accurate.
double student_quantile(double nu, double z) {
  double rest = 0.0;
  const double y =
      z < 1.0 ? boost::math::ibetac_inv(0.5 * nu, 0.5, std::erf(z / std::numbers::sqrt2), &rest,
                                        Policy{})
              : boost::math::ibeta_inv(0.5 * nu, 0.5, 2.0 * normal_cdf(-z), &rest, Policy{});
  return std::sqrt(nu) * std::sqrt(rest) / std::sqrt(y);
}

// ln(1 + u²), even if u² overflows.
double log1p_square(double u) {
  return std::fabs(u) < 1e8 ? std::log1p(u * u) : 2.0 * std::log(std::fabs(u));
}

// Order-preserving map of doubles to integers: neighbours differ by one.
std::int64_t rank(double x) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
}

double of_rank(std::int64_t rank) {
  return std::bit_cast<double>(rank < 0 ? std::numeric_limits<std::int64_t>::min() - rank : rank);
}

struct Moments {
  double mean, sd;
};

constexpr double kFine = 0.004;  // a user-defined density may have kinks

// ∫ x(z) φ(z) dz by the trapezoidal rule, which converges exponentially for a smooth integrand.
Moments moments_by_quadrature(const Prior& prior, double step = 0.1) {
  const int half = static_cast<int>(std::lround(8.0 / step));
  const double centre = prior.from_standard_normal(0.0);
  double w = 0.0, first = 0.0, second = 0.0;
  for (int i = -half; i <= half; ++i) {
    const double z = step * i;
    const double weight = std::exp(-0.5 * z * z);
    const double d = prior.from_standard_normal(z) - centre;
    w += weight;
    first += weight * d;
    second += weight * d * d;
  }
  first /= w;
  return {centre + first, std::sqrt(std::fmax(0.0, second / w - first * first))};
}

}  // namespace

// Bisection over all doubles between the bounds; ends at the nearest double.
double Distribution::quantile(Tails t) const {
  if (t.below == 0.0) return lower();
  if (t.above == 0.0) return upper();
  std::int64_t low = rank(lower()), high = rank(upper());
  while (std::midpoint(low, high) != low) {
    const std::int64_t middle = std::midpoint(low, high);
    const Tails here = tails(of_rank(middle));
    const bool too_low = t.below < t.above ? here.below < t.below : here.above > t.above;
    (too_low ? low : high) = middle;
  }
  return of_rank(high);
}

Prior::Prior(Family family) : family_(std::move(family)) {
  log_normaliser_ = std::visit(
      Overloaded{
          [](const Uniform& f) {
            require_interval("uniform", f.lower, f.upper);
            return -std::log(f.upper - f.lower);
          },
          [](const LogUniform& f) {
            require_positive("log_uniform", "lower", f.lower);
            require_interval("log_uniform", f.lower, f.upper);
            return -std::log(log_span(f));
          },
          [](const Normal& f) {
            require_finite("normal", "mean", f.mean);
            require_positive("normal", "sd", f.sd);
            return -kLogSqrt2Pi - std::log(f.sd);
          },
          [](const LogNormal& f) {
            require_finite("log_normal", "mu", f.mu);
            require_positive("log_normal", "sigma", f.sigma);
            return -kLogSqrt2Pi - std::log(f.sigma);
          },
          [](const HalfNormal& f) {
            require_positive("half_normal", "sd", f.sd);
            return std::numbers::ln2 - kLogSqrt2Pi - std::log(f.sd);
          },
          [](const Gamma& f) {
            require_positive("gamma", "shape", f.shape);
            require_positive("gamma", "scale", f.scale);
            return -boost::math::lgamma(f.shape, Policy{}) - std::log(f.scale);
          },
          [](const Beta& f) {
            require_positive("beta", "a", f.a);
            require_positive("beta", "b", f.b);
            require_interval("beta", f.lower, f.upper);
            return boost::math::lgamma(f.a + f.b, Policy{}) - boost::math::lgamma(f.a, Policy{}) -
                   boost::math::lgamma(f.b, Policy{}) - std::log(f.upper - f.lower);
          },
          [](const TruncatedNormal& f) {
            constexpr const char* kName = "truncated_normal";
            require_finite(kName, "mean", f.mean);
            require_positive(kName, "sd", f.sd);
            // The density is proper even with one or two infinite bounds.
            if (std::isnan(f.lower) || f.lower == kInfinity)
              refuse(kName, "lower", f.lower, "a number below upper");
            if (std::isnan(f.upper) || f.upper == -kInfinity)
              refuse(kName, "upper", f.upper, "a number above lower");
            if (!(f.lower < f.upper))
              refuse(kName, "lower", f.lower, ("< upper = " + base::number(f.upper)).c_str());
            // For larger distances, the squares overflow.
            const double remote = std::max({f.lower - f.mean, f.mean - f.upper, 0.0}) / f.sd;
            if (!(remote <= 1e100))
              refuse(kName, "sd", f.sd,
                     "at least 1e-100 times the distance of the mean from the interval");
            return -kLogSqrt2Pi - std::log(f.sd) - StandardTruncated(f).log_mass();
          },
          [](const InverseGamma& f) {
            require_positive("inverse_gamma", "shape", f.shape);
            require_positive("inverse_gamma", "scale", f.scale);
            return -boost::math::lgamma(f.shape, Policy{}) - std::log(f.scale);
          },
          [](const StudentT& f) {
            require_positive("student_t", "nu", f.nu);
            require_finite("student_t", "location", f.location);
            require_positive("student_t", "scale", f.scale);
            return -std::log(boost::math::tgamma_delta_ratio(0.5 * f.nu, 0.5, Policy{})) -
                   0.5 * std::log(f.nu * std::numbers::pi) - std::log(f.scale);
          },
          [](const OwnPrior& f) {
            if (f.distribution == nullptr)
              throw std::invalid_argument("user-defined prior: the distribution is null");
            const double from = f.distribution->lower(), to = f.distribution->upper();
            if (!(from < to))
              refuse(f.distribution->describe().c_str(), "lower", from,
                     ("< upper = " + base::number(to)).c_str());
            return 0.0;
          }},
      family_);
}

double Prior::log_density(double x) const {
  if (std::isnan(x) || x < lower() || x > upper()) return -kInfinity;
  return std::visit(Overloaded{[&](const Uniform&) { return log_normaliser_; },
                               [&](const LogUniform&) { return log_normaliser_ - std::log(x); },
                               [&](const Normal& f) {
                                 const double u = (x - f.mean) / f.sd;
                                 return log_normaliser_ - 0.5 * u * u;
                               },
                               [&](const LogNormal& f) {
                                 if (x == 0.0) return -kInfinity;
                                 const double log_x = std::log(x), u = (log_x - f.mu) / f.sigma;
                                 return log_normaliser_ - log_x - 0.5 * u * u;
                               },
                               [&](const HalfNormal& f) {
                                 const double u = x / f.sd;
                                 return log_normaliser_ - 0.5 * u * u;
                               },
                               [&](const Gamma& f) {
                                 const double u = x / f.scale;
                                 if (f.shape == 1.0) return log_normaliser_ - u;
                                 if (std::isinf(u)) return -kInfinity;
                                 return log_normaliser_ + (f.shape - 1.0) * std::log(u) - u;
                               },
                               [&](const Beta& f) {
                                 const double width = f.upper - f.lower;
                                 double sum = log_normaliser_;
                                 if (f.a != 1.0)
                                   sum += (f.a - 1.0) * std::log((x - f.lower) / width);
                                 if (f.b != 1.0)
                                   sum += (f.b - 1.0) * std::log((f.upper - x) / width);
                                 return sum;
                               },
                               [&](const TruncatedNormal& f) {
                                 const double u = (x - f.mean) / f.sd;
                                 return log_normaliser_ - 0.5 * u * u;
                               },
                               [&](const InverseGamma& f) {
                                 const double u = f.scale / x;
                                 if (u == 0.0 || std::isinf(u)) return -kInfinity;
                                 return log_normaliser_ + (f.shape + 1.0) * std::log(u) - u;
                               },
                               [&](const StudentT& f) {
                                 const double u = (x - f.location) / f.scale / std::sqrt(f.nu);
                                 return log_normaliser_ - 0.5 * (f.nu + 1.0) * log1p_square(u);
                               },
                               [&](const OwnPrior& f) {
                                 return x > lower() && x < upper() ? f.distribution->log_density(x)
                                                                   : -kInfinity;
                               }},
                    family_);
}

double Prior::from_standard_normal(double z) const {
  return std::visit(
      Overloaded{
          [z](const Uniform& f) { return interpolate(f.lower, f.upper, z); },
          [z](const LogUniform& f) {
            const double span = log_span(f);
            const double x = z < 0.0 ? f.lower * std::exp(span * normal_cdf(z))
                                     : f.upper * std::exp(-span * normal_cdf(-z));
            return clamp(x, f.lower, f.upper);
          },
          [z](const Normal& f) { return f.mean + f.sd * z; },
          [z](const LogNormal& f) { return std::exp(f.mu + f.sigma * z); },
          [z](const HalfNormal& f) {
            // F(x) = 2Φ(x/sd) - 1
            return f.sd * (z < 0.0 ? normal_quantile_from_centre(0.5 * normal_cdf(z))
                                   : -normal_quantile(0.5 * normal_cdf(-z)));
          },
          [z](const Gamma& f) {
            return f.scale * (z < 0.0
                                  ? boost::math::gamma_p_inv(f.shape, normal_cdf(z), Policy{})
                                  : boost::math::gamma_q_inv(f.shape, normal_cdf(-z), Policy{}));
          },
          [z](const Beta& f) {
            const auto [t, rest] = beta_quantile(f, z);
            const double width = f.upper - f.lower;
            return clamp(t < 0.5 ? f.lower + width * t : f.upper - width * rest, f.lower, f.upper);
          },
          [z](const TruncatedNormal& f) {
            const StandardTruncated cut(f);
            const double u = cut.reflected ? -cut.quantile(normal_cdf(-z), normal_cdf(z))
                                           : cut.quantile(normal_cdf(z), normal_cdf(-z));
            return clamp(f.mean + f.sd * u, f.lower, f.upper);
          },
          [z](const InverseGamma& f) {
            return f.scale / (z < 0.0
                                  ? boost::math::gamma_q_inv(f.shape, normal_cdf(z), Policy{})
                                  : boost::math::gamma_p_inv(f.shape, normal_cdf(-z), Policy{}));
          },
          [z](const StudentT& f) {
            return f.location + f.scale * std::copysign(student_quantile(f.nu, std::fabs(z)), z);
          },
          [z, this](const OwnPrior& f) {
            return clamp(f.distribution->quantile({normal_cdf(z), normal_cdf(-z)}), lower(),
                         upper());
          }},
      family_);
}

double Prior::slope(double z) const {
  const double log_phi = -0.5 * z * z - kLogSqrt2Pi;
  const double x = from_standard_normal(z);
  // Uses logarithms, because φ and p are small in the tails. The density is 0 or ∞ only at a bound.
  const auto by_density = [&](double log_p) {
    const double slope = std::exp(log_phi - log_p);
    return std::isfinite(log_p) && std::isfinite(slope) ? slope : 0.0;
  };
  return std::visit(
      Overloaded{
          [&](const Uniform& f) { return (f.upper - f.lower) * std::exp(log_phi); },
          [&](const LogUniform& f) { return x * log_span(f) * std::exp(log_phi); },
          [](const Normal& f) { return f.sd; }, [&](const LogNormal& f) { return f.sigma * x; },
          [&](const Beta& f) {
            // 1 - t would lose accuracy for t near 1.
            const auto [t, rest] = beta_quantile(f, z);
            return t > 0.0 && rest > 0.0 ? by_density(log_normaliser_ + (f.a - 1.0) * std::log(t) +
                                                      (f.b - 1.0) * std::log(rest))
                                         : 0.0;
          },
          [&](const auto&) { return by_density(log_density(x)); }},
      family_);
}

double Prior::to_standard_normal(double x) const {
  if (x <= lower()) return -kInfinity;
  if (x >= upper()) return kInfinity;
  return std::visit(
      Overloaded{
          [x](const Uniform& f) {
            const double width = f.upper - f.lower;
            return from_tails((x - f.lower) / width, (f.upper - x) / width);
          },
          [x](const LogUniform& f) {
            const double span = log_span(f);
            return from_tails(log_quotient(x, f.lower) / span, log_quotient(f.upper, x) / span);
          },
          [x](const Normal& f) { return (x - f.mean) / f.sd; },
          [x](const LogNormal& f) { return (std::log(x) - f.mu) / f.sigma; },
          [x](const HalfNormal& f) {
            const double u = x / f.sd;
            if (u < 1.0) return normal_quantile(std::erf(u / std::numbers::sqrt2));
            return -normal_quantile_of_log(std::numbers::ln2 + log_normal_cdf(-u));
          },
          [x](const Gamma& f) {
            const double u = x / f.scale;
            return from_tails(boost::math::gamma_p(f.shape, u, Policy{}),
                              boost::math::gamma_q(f.shape, u, Policy{}));
          },
          [x](const Beta& f) {
            const double width = f.upper - f.lower;
            const double t = (x - f.lower) / width, rest = (f.upper - x) / width;
            // I_t(a, b) = 1 - I_{1-t}(b, a). The smaller argument is accurate.
            if (t < 0.5)
              return from_tails(boost::math::ibeta(f.a, f.b, t, Policy{}),
                                boost::math::ibetac(f.a, f.b, t, Policy{}));
            return from_tails(boost::math::ibetac(f.b, f.a, rest, Policy{}),
                              boost::math::ibeta(f.b, f.a, rest, Policy{}));
          },
          [x](const TruncatedNormal& f) {
            const StandardTruncated cut(f);
            const double u = (x - f.mean) / f.sd;
            return cut.reflected ? -cut.to_standard(-u) : cut.to_standard(u);
          },
          [x](const InverseGamma& f) {
            const double u = f.scale / x;
            return from_tails(boost::math::gamma_q(f.shape, u, Policy{}),
                              boost::math::gamma_p(f.shape, u, Policy{}));
          },
          [x](const StudentT& f) {
            const double t = (x - f.location) / f.scale;
            return std::copysign(-normal_quantile(student_upper_tail(f.nu, std::fabs(t))), t);
          },
          [x](const OwnPrior& f) {
            const auto [below, above] = f.distribution->tails(x);
            return from_tails(below, above);
          }},
      family_);
}

double Prior::lower() const {
  return std::visit(
      Overloaded{[](const Normal&) { return -kInfinity; }, [](const LogNormal&) { return 0.0; },
                 [](const HalfNormal&) { return 0.0; }, [](const Gamma&) { return 0.0; },
                 [](const InverseGamma&) { return 0.0; },
                 [](const StudentT&) { return -kInfinity; },
                 [](const OwnPrior& f) { return f.distribution->lower(); },
                 [](const auto& f) { return f.lower; }},
      family_);
}

double Prior::upper() const {
  return std::visit(
      Overloaded{
          [](const Normal&) { return kInfinity; }, [](const LogNormal&) { return kInfinity; },
          [](const HalfNormal&) { return kInfinity; }, [](const Gamma&) { return kInfinity; },
          [](const InverseGamma&) { return kInfinity; }, [](const StudentT&) { return kInfinity; },
          [](const OwnPrior& f) { return f.distribution->upper(); },
          [](const auto& f) { return f.upper; }},
      family_);
}

double Prior::mean() const {
  return std::visit(
      Overloaded{[](const Uniform& f) { return f.lower + 0.5 * (f.upper - f.lower); },
                 [](const LogUniform& f) { return (f.upper - f.lower) / log_span(f); },
                 [](const Normal& f) { return f.mean; },
                 [](const LogNormal& f) { return std::exp(f.mu + 0.5 * f.sigma * f.sigma); },
                 [](const HalfNormal& f) { return f.sd * std::sqrt(2.0 * std::numbers::inv_pi); },
                 [](const Gamma& f) { return f.shape * f.scale; },
                 [](const Beta& f) { return f.lower + (f.upper - f.lower) * f.a / (f.a + f.b); },
                 [this](const TruncatedNormal&) { return moments_by_quadrature(*this).mean; },
                 [](const InverseGamma& f) {
                   return f.shape > 1.0 ? f.scale / (f.shape - 1.0) : kInfinity;
                 },
                 [](const StudentT& f) { return f.location; },
                 [this](const OwnPrior&) { return moments_by_quadrature(*this, kFine).mean; }},
      family_);
}

double Prior::sd() const {
  return std::visit(
      Overloaded{
          [](const Uniform& f) { return (f.upper - f.lower) / std::sqrt(12.0); },
          [this](const LogUniform&) { return moments_by_quadrature(*this).sd; },
          [](const Normal& f) { return f.sd; },
          [this](const LogNormal& f) { return mean() * std::sqrt(std::expm1(f.sigma * f.sigma)); },
          [](const HalfNormal& f) { return f.sd * std::sqrt(1.0 - 2.0 * std::numbers::inv_pi); },
          [](const Gamma& f) { return std::sqrt(f.shape) * f.scale; },
          [](const Beta& f) {
            const double n = f.a + f.b;
            return (f.upper - f.lower) * std::sqrt(f.a / n * (f.b / n) / (n + 1.0));
          },
          [this](const TruncatedNormal&) { return moments_by_quadrature(*this).sd; },
          [](const InverseGamma& f) {
            return f.shape > 2.0 ? f.scale / (f.shape - 1.0) / std::sqrt(f.shape - 2.0) : kInfinity;
          },
          [](const StudentT& f) {
            return f.nu > 2.0 ? f.scale * std::sqrt(f.nu / (f.nu - 2.0)) : kInfinity;
          },
          [this](const OwnPrior&) { return moments_by_quadrature(*this, kFine).sd; }},
      family_);
}

std::string Prior::describe() const {
  return std::visit(
      Overloaded{[](const Uniform& f) {
                   return "uniform " + list({f.lower, f.upper});
                 },
                 [](const LogUniform& f) {
                   return "log_uniform " + list({f.lower, f.upper});
                 },
                 [](const Normal& f) {
                   return "normal " + list({f.mean, f.sd});
                 },
                 [](const LogNormal& f) {
                   return "log_normal " + list({f.mu, f.sigma});
                 },
                 [](const HalfNormal& f) { return "half_normal " + base::number(f.sd); },
                 [](const Gamma& f) {
                   return "gamma " + list({f.shape, f.scale});
                 },
                 [](const Beta& f) {
                   const std::string text = "beta " + list({f.a, f.b});
                   return f.lower == 0.0 && f.upper == 1.0
                              ? text
                              : text + " on " + list({f.lower, f.upper});
                 },
                 [](const TruncatedNormal& f) {
                   return "truncated_normal " + list({f.mean, f.sd, f.lower, f.upper});
                 },
                 [](const InverseGamma& f) {
                   return "inverse_gamma " + list({f.shape, f.scale});
                 },
                 [](const StudentT& f) {
                   return "student_t " + list({f.nu, f.location, f.scale});
                 },
                 [](const OwnPrior& f) { return f.distribution->describe(); }},
      family_);
}

}  // namespace wheeltap::inference
