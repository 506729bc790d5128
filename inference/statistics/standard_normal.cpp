#include "inference/statistics/standard_normal.hpp"

#include <cmath>
#include <numbers>

#include "base/constants.hpp"

namespace wheeltap::inference {
namespace {

// AS 241 (PPND16): three rational approximations of degree 7, in q² about the centre and in
// r = √(-ln p) in the tails.
double centre(double q) {
  const double r = 0.180625 - q * q;
  return q *
         (((((((2.5090809287301226727e3 * r + 3.3430575583588128105e4) * r +
               6.7265770927008700853e4) *
                  r +
              4.5921953931549871457e4) *
                 r +
             1.3731693765509461125e4) *
                r +
            1.9715909503065514427e3) *
               r +
           1.3314166789178437745e2) *
              r +
          3.3871328727963666080e0) /
         (((((((5.2264952788528545610e3 * r + 2.8729085735721942674e4) * r +
               3.9307895800092710610e4) *
                  r +
              2.1213794301586595867e4) *
                 r +
             5.3941960214247511077e3) *
                r +
            6.8718700749205790830e2) *
               r +
           4.2313330701600911252e1) *
              r +
          1.0);
}

// The magnitude of the quantile for p <= 0.075 with r = √(-ln p), r <= 27.
double tail(double r) {
  if (r <= 5.0) {
    r -= 1.6;
    return (((((((7.74545014278341407640e-4 * r + 2.27238449892691845833e-2) * r +
                 2.41780725177450611770e-1) *
                    r +
                1.27045825245236838258e0) *
                   r +
               3.64784832476320460504e0) *
                  r +
              5.76949722146069140550e0) *
                 r +
             4.63033784615654529590e0) *
                r +
            1.42343711074968357734e0) /
           (((((((1.05075007164441684324e-9 * r + 5.47593808499534494600e-4) * r +
                 1.51986665636164571966e-2) *
                    r +
                1.48103976427480074590e-1) *
                   r +
               6.89767334985100004550e-1) *
                  r +
              1.67638483018380384940e0) *
                 r +
             2.05319162663775882187e0) *
                r +
            1.0);
  }
  r -= 5.0;
  return (((((((2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r +
               1.24266094738807843860e-3) *
                  r +
              2.65321895265761230930e-2) *
                 r +
             2.96560571828504891230e-1) *
                r +
            1.78482653991729133580e0) *
               r +
           5.46378491116411436990e0) *
              r +
          6.65790464350110377720e0) /
         (((((((2.04426310338993978564e-15 * r + 1.42151175831644588870e-7) * r +
               1.84631831751005468180e-5) *
                  r +
              7.86869131145613259100e-4) *
                 r +
             1.48753612908506148525e-2) *
                r +
            1.36929880922735805310e-1) *
               r +
           5.99832206555887937690e-1) *
              r +
          1.0);
}

// Mills' ratio Φ(-t)/φ(t) for t >= 30 by its asymptotic series, 1 - s + 3s² - 15s³ …, s = t⁻². The
// error of eight terms is 15!! · 30⁻¹⁶ · 17 < 1e-16.
double mills(double t) {
  const double s = 1.0 / (t * t);
  double sum = 1.0;
  for (int odd = 15; odd >= 1; odd -= 2) sum = 1.0 - odd * s * sum;
  return sum / t;
}

}  // namespace

double normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

double normal_quantile_from_centre(double q) {
  if (std::fabs(q) <= 0.425) return centre(q);
  return q < 0.0 ? normal_quantile(0.5 + q) : -normal_quantile(0.5 - q);
}

double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::fabs(q) <= 0.425) return centre(q);
  const double outer = q < 0.0 ? p : 1.0 - p;
  if (!(outer >= 0.0)) return kNaN;
  if (outer == 0.0) return q < 0.0 ? -kInfinity : kInfinity;
  const double z = tail(std::sqrt(-std::log(outer)));
  return q < 0.0 ? -z : z;
}

double log_normal_cdf(double z) {
  if (z > 5.0) return std::log1p(-normal_cdf(-z));
  if (z > -30.0) return std::log(normal_cdf(z));
  if (z == -kInfinity) return -kInfinity;
  return -0.5 * z * z - kLogSqrt2Pi + std::log(mills(-z));
}

double normal_quantile_of_log(double lp) {
  if (!(lp <= 0.0)) return kNaN;
  if (lp == -kInfinity) return -kInfinity;
  if (lp > -1.0) return -normal_quantile(-std::expm1(lp));
  if (lp > -700.0) return normal_quantile(std::exp(lp));
  // Newton's method on ln Φ(-t) = lp, whose slope is -1/mills(t); converges quadratically from a
  // start accurate to t⁻².
  double t = std::sqrt(-2.0 * lp);
  t = std::sqrt(-2.0 * (lp + kLogSqrt2Pi + std::log(t)));
  for (int i = 0; i < 3; ++i) t += (log_normal_cdf(-t) - lp) * mills(t);
  return -t;
}

double log_sum_exp(double a, double b) {
  const double top = a > b ? a : b;
  if (top == -kInfinity) return top;
  return top + std::log1p(std::exp((a > b ? b : a) - top));
}

double log_diff_exp(double a, double b) {
  if (b == -kInfinity) return a;
  const double d = b - a;  // <= 0
  return a + (d > -std::numbers::ln2 ? std::log(-std::expm1(d)) : std::log1p(-std::exp(d)));
}

}  // namespace wheeltap::inference
