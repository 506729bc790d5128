#include "inference/model/prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "inference/model/tabulated_prior.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

// F = 1/(1 + e^-x), with quantiles by the default search.
class Logistic : public Distribution {
 public:
  [[nodiscard]] double log_density(double x) const override {
    return -std::fabs(x) - 2.0 * std::log1p(std::exp(-std::fabs(x)));
  }
  [[nodiscard]] Tails tails(double x) const override {
    return {1.0 / (1.0 + std::exp(-x)), 1.0 / (1.0 + std::exp(x))};
  }
  [[nodiscard]] double lower() const override { return -kInfinity; }
  [[nodiscard]] double upper() const override { return kInfinity; }
  [[nodiscard]] std::string describe() const override { return "logistic"; }
};

// Linear up to 1, and then decreasing to a step.
OwnPrior table() {
  return {std::make_shared<TabulatedPrior>(std::vector<double>{0.0, 1.0, 1.5, 3.0},
                                           std::vector<double>{0.0, 4.0, 2.0, 1.0})};
}

std::vector<Prior> every_family() {
  return {Uniform{-3.0, 5.0},
          Uniform{1e9, 1e9 + 1e3},
          LogUniform{1e-3, 1e4},
          Normal{2.0, 0.5},
          LogNormal{-1.0, 0.7},
          HalfNormal{3.0},
          Gamma{0.4, 2.0},
          Gamma{1.0, 0.1},
          Gamma{7.5, 1e6},
          Beta{2.0, 3.0},
          Beta{0.5, 0.5, -1.0, 4.0},
          Beta{30.0, 1.0, 0.0, 0.6},
          TruncatedNormal{0.0, 1.0, -1.0, 2.0},
          TruncatedNormal{0.0, 1.0, 3.0, kInfinity},
          TruncatedNormal{5.0, 2.0, -kInfinity, 4.0},
          TruncatedNormal{0.0, 1.0, 40.0, 41.0},
          TruncatedNormal{0.0, 1.0, -41.0, -40.0},
          TruncatedNormal{0.0, 1.0, 2e4, kInfinity},
          TruncatedNormal{0.0, 1.0, 0.5, 0.5 + 1e-6},
          InverseGamma{6.0, 2.0},
          InverseGamma{30.0, 1e-6},
          StudentT{8.0, 1.0, 2.0},
          StudentT{5.5, -1e3, 0.1},
          StudentT{1e6, 0.0, 1.0},
          table(),
          OwnPrior{std::make_shared<Logistic>()}};
}

// Φ⁻¹ against Φ = erfc from the C library, over the whole range of doubles.
TEST(StandardNormal, QuantileInvertsTheDistributionFunction) {
  for (double z = -37.0; z <= 8.0; z += 0.0625) {
    const double p = normal_cdf(z);
    // dz = dp/φ; p carries an error of z² rounding units in the lower tail and of one in the upper.
    const double density = std::exp(-0.5 * z * z - kLogSqrt2Pi);
    const double tolerance = 4e-16 * (1.0 + z * z) * p / density + 4e-16 * (1.0 + std::fabs(z));
    EXPECT_NEAR(normal_quantile(p), z, tolerance) << z;
    if (std::fabs(z) < 1.0) {
      EXPECT_NEAR(normal_quantile_from_centre(0.5 * std::erf(z / std::sqrt(2.0))), z,
                  2e-15 * std::fabs(z));
    }
    EXPECT_NEAR(normal_quantile_of_log(log_normal_cdf(z)), z, tolerance) << z;
  }
  for (const double z : {-38.0, -45.0, -100.0, -1e4, -1e8})
    EXPECT_NEAR(normal_quantile_of_log(log_normal_cdf(z)) / z, 1.0, 1e-15) << z;
  EXPECT_EQ(normal_quantile(0.0), -kInfinity);
  EXPECT_EQ(normal_quantile(1.0), kInfinity);
  EXPECT_TRUE(std::isnan(normal_quantile(1.5)));
  EXPECT_TRUE(std::isnan(normal_quantile(kNaN)));
}

// The two branches of ln Φ agree: a jump at z = -30 would show as a wrong slope.
TEST(StandardNormal, LogDistributionFunctionIsSmoothAcrossItsBranches) {
  EXPECT_NEAR(log_normal_cdf(-30.0 + 1e-9) - log_normal_cdf(-30.0 - 1e-9), 2e-9 * 30.033, 5e-12);
  EXPECT_NEAR(log_normal_cdf(5.0 + 1e-9), log_normal_cdf(5.0 - 1e-9), 1e-14);
}

// The density, integrated over the image of z in (-8, 8), by the chain rule ∫ p(x(z)) x'(z) dz: one
// only if the density is normalised *and* x(z) is its quantile function. The stronger condition
// p(x) dx = φ(z) dz is checked at each point.
TEST(Prior, DensityMatchesItsTransform) {
  for (const Prior& prior : every_family()) {
    for (double z = -5.0; z <= 5.0; z += 0.25) {
      constexpr double kStep = 1e-3;
      // Sixth-order central difference of x(z).
      const auto x = [&](int i) { return prior.from_standard_normal(z + i * kStep); };
      const double slope =
          (45.0 * (x(1) - x(-1)) - 9.0 * (x(2) - x(-2)) + (x(3) - x(-3))) / (60.0 * kStep);
      const double rounding = 1e-15 * std::fabs(x(0)) / kStep;
      if (rounding > 1e-2 * slope) continue;  // x no longer resolves z there
      const double jacobian = std::log(slope);
      EXPECT_NEAR(prior.log_density(x(0)) + jacobian, -0.5 * z * z - kLogSqrt2Pi,
                  2e-8 + 10.0 * rounding / slope)
          << prior.describe() << " at z = " << z;
    }
  }
}

TEST(Prior, TransformInvertsInBothTails) {
  for (const Prior& prior : every_family()) {
    double previous = -kInfinity;
    for (double z = -8.0; z <= 8.0; z += 0.125) {
      const double x = prior.from_standard_normal(z);
      EXPECT_GE(x, previous) << prior.describe();
      EXPECT_GE(x, prior.lower());
      EXPECT_LE(x, prior.upper());
      previous = x;
      // Change of z due to the rounding of x, or of its distance from a bound, to a double.
      const double up = prior.to_standard_normal(x + 4e-16 * (std::fabs(x) + 1e-300));
      const double down = prior.to_standard_normal(x - 4e-16 * (std::fabs(x) + 1e-300));
      if (std::isinf(up) || std::isinf(down)) continue;
      EXPECT_NEAR(prior.to_standard_normal(x), z, 2e-9 + 4.0 * (up - down))
          << prior.describe() << " at z = " << z;
    }
  }
}

// Regression: from z = -8.3 on, the value was the distant bound.
TEST(Prior, DistantBoundsHaveNoEffectInTheTails) {
  const Prior below = TruncatedNormal{1.0, 0.02, 0.0, kInfinity};
  const Prior above = TruncatedNormal{1.0, 0.02, -kInfinity, 2.0};
  for (const double z : {-12.0, -8.4, -8.25, -7.9, 0.0, 7.9, 8.25, 8.4, 12.0}) {
    EXPECT_NEAR(below.from_standard_normal(z), 1.0 + 0.02 * z, 1e-9) << z;
    EXPECT_NEAR(above.from_standard_normal(z), 1.0 + 0.02 * z, 1e-9) << z;
  }
}

TEST(Prior, TailsResolveAtTheEndsOfTheSupport) {
  const Prior unit = Uniform{0.0, 1.0};
  EXPECT_NEAR(unit.to_standard_normal(unit.from_standard_normal(-30.0)), -30.0, 1e-12);
  const Prior half = HalfNormal{1.0};
  EXPECT_NEAR(half.to_standard_normal(half.from_standard_normal(-30.0)), -30.0, 1e-12);
  EXPECT_NEAR(half.to_standard_normal(half.from_standard_normal(30.0)), 30.0, 1e-12);
  EXPECT_TRUE(std::isfinite(half.to_standard_normal(60.0)));
  const Prior gamma = Gamma{3.0, 2.0};
  EXPECT_NEAR(gamma.to_standard_normal(gamma.from_standard_normal(-20.0)), -20.0, 1e-9);
  EXPECT_NEAR(gamma.to_standard_normal(gamma.from_standard_normal(20.0)), 20.0, 1e-9);
  for (const Prior& prior : every_family()) {
    EXPECT_EQ(prior.to_standard_normal(prior.lower()), -kInfinity);
    EXPECT_EQ(prior.to_standard_normal(prior.upper()), kInfinity);
    EXPECT_FALSE(std::isnan(prior.from_standard_normal(-40.0)));
    EXPECT_FALSE(std::isnan(prior.from_standard_normal(40.0)));
  }
}

TEST(Prior, ClosedFormValues) {
  EXPECT_NEAR(Prior(Uniform{0.0, 4.0}).log_density(1.0), -std::log(4.0), 1e-15);
  EXPECT_NEAR(Prior(Uniform{2.0, 4.0}).from_standard_normal(0.0), 3.0, 1e-15);
  // The geometric mean is the median.
  EXPECT_NEAR(Prior(LogUniform{1e-2, 1e2}).from_standard_normal(0.0), 1.0, 1e-14);
  // Beta(2,3): p(x) = 12 x (1-x)².
  EXPECT_NEAR(Prior(Beta{2.0, 3.0}).log_density(0.25), std::log(12.0 * 0.25 * 0.5625), 1e-14);
  EXPECT_NEAR(Prior(Beta{2.0, 3.0}).mean(), 0.4, 1e-15);
  EXPECT_NEAR(Prior(Beta{2.0, 3.0}).sd(), 0.2, 1e-15);
  // Gamma(1, s) is exponential: F = 1 - e^{-x/s}, with median s ln 2.
  EXPECT_NEAR(Prior(Gamma{1.0, 3.0}).from_standard_normal(0.0), 3.0 * std::log(2.0), 1e-13);
  EXPECT_NEAR(Prior(HalfNormal{2.0}).log_density(1.0),
              std::log(std::sqrt(2.0 / M_PI) / 2.0) - 0.125, 1e-14);
  // Half of N(0, 1) is both a half normal and a truncated normal.
  const Prior half = HalfNormal{1.0}, cut = TruncatedNormal{0.0, 1.0, 0.0, kInfinity};
  for (double z = -4.0; z <= 6.0; z += 0.5) {
    EXPECT_NEAR(half.from_standard_normal(z), cut.from_standard_normal(z), 1e-14 * (1.0 + z * z));
    EXPECT_NEAR(half.log_density(0.3 * (z + 4.0)), cut.log_density(0.3 * (z + 4.0)), 1e-13);
  }
  EXPECT_NEAR(half.mean(), cut.mean(), 1e-9);
  EXPECT_NEAR(half.sd(), cut.sd(), 1e-9);
  // Inverse gamma of shape 1: F = e^{-s/x}. Its mean is infinite, not NaN.
  const Prior inverse = InverseGamma{1.0, 3.0};
  EXPECT_NEAR(inverse.from_standard_normal(0.0), 3.0 / std::log(2.0), 1e-13);
  EXPECT_NEAR(inverse.log_density(2.0), std::log(3.0 / 4.0) - 1.5, 1e-14);
  EXPECT_EQ(inverse.mean(), kInfinity);
  EXPECT_EQ(Prior(InverseGamma{2.0, 1.0}).sd(), kInfinity);
  // Cauchy's quartiles, and t of 2 degrees: F = ½ + t / (2 √(2 + t²)).
  const Prior cauchy = StudentT{1.0, 2.0, 3.0};
  EXPECT_NEAR(cauchy.from_standard_normal(normal_quantile(0.75)), 5.0, 1e-13);
  EXPECT_NEAR(cauchy.log_density(5.0), -std::log(M_PI * 3.0 * 2.0), 1e-14);
  EXPECT_EQ(cauchy.sd(), kInfinity);
  EXPECT_NEAR(Prior(StudentT{2.0, 0.0, 1.0}).to_standard_normal(1.0),
              normal_quantile(0.5 + 0.5 / std::sqrt(3.0)), 1e-14);
  // ν → ∞ is normal.
  EXPECT_NEAR(Prior(StudentT{1e9, 0.0, 1.0}).log_density(1.0),
              Prior(Normal{0.0, 1.0}).log_density(1.0), 1e-8);
  // Far in both tails of Cauchy's distribution: 1 / (π |x|).
  EXPECT_NEAR(cauchy.to_standard_normal(2.0 - 3e12) / normal_quantile(1e-12 / M_PI), 1.0, 1e-12);
  EXPECT_NEAR(cauchy.to_standard_normal(2.0 + 3e12) / -normal_quantile(1e-12 / M_PI), 1.0, 1e-12);
}

// The areas of trapezia: 2, 1.5 and 2.25 of 5.75.
TEST(Prior, TableIsLinearBetweenItsPoints) {
  const Prior prior = table();
  EXPECT_NEAR(prior.log_density(0.25), std::log(1.0 / 5.75), 1e-14);
  EXPECT_NEAR(prior.log_density(2.25), std::log(1.5 / 5.75), 1e-14);
  EXPECT_NEAR(prior.to_standard_normal(1.0), normal_quantile(2.0 / 5.75), 1e-14);
  EXPECT_NEAR(prior.from_standard_normal(normal_quantile(3.5 / 5.75)), 1.5, 1e-14);
  // ∫ x p: cell by cell h (p_0 (2 x_0 + x_1) + p_1 (x_0 + 2 x_1)) / 6.
  const double first =
      4.0 * 2.0 / 6.0 + 0.5 * (4.0 * 3.5 + 2.0 * 4.0) / 6.0 + 1.5 * (2.0 * 6.0 + 1.0 * 7.5) / 6.0;
  EXPECT_NEAR(prior.mean(), first / 5.75, 1e-4);
  EXPECT_EQ(prior.log_density(-0.1), -kInfinity);
  EXPECT_EQ(prior.log_density(3.1), -kInfinity);
  EXPECT_EQ(prior.describe(), "table of 4 on [0, 3]");
  // The unit of the table does not matter, and neither does that of a uniform density.
  const Prior huge = OwnPrior{std::make_shared<TabulatedPrior>(
      std::vector<double>{0.0, 1.0, 1.5, 3.0}, std::vector<double>{0.0, 4e300, 2e300, 1e300})};
  EXPECT_NEAR(huge.log_density(1.2), prior.log_density(1.2), 1e-14);
  const Prior flat = OwnPrior{std::make_shared<TabulatedPrior>(
      std::vector<double>{-1e-3, 0.0, 5e-3}, std::vector<double>{7.0, 7.0, 7.0})};
  const Prior uniform = Uniform{-1e-3, 5e-3};
  for (double z = -6.0; z <= 6.0; z += 0.7) {
    EXPECT_NEAR(flat.from_standard_normal(z), uniform.from_standard_normal(z), 1e-17);
    EXPECT_NEAR(flat.to_standard_normal(flat.from_standard_normal(z)),
                uniform.to_standard_normal(flat.from_standard_normal(z)), 1e-9);
  }
}

// Regression: slopes of the density underflowed, and quantiles decreased.
TEST(Prior, TableMaySpanAllMagnitudes) {
  const Prior prior = OwnPrior{std::make_shared<TabulatedPrior>(
      std::vector<double>{-1e307, 0.0, 1e307}, std::vector<double>{0.0, 1.0, 0.0})};
  for (const double z : {-3.0, -1.0, 0.0, 0.5, 3.0}) {
    const double p = normal_cdf(z), q = normal_cdf(-z);
    const double expected = p < q ? std::sqrt(2.0 * p) - 1.0 : 1.0 - std::sqrt(2.0 * q);
    EXPECT_NEAR(prior.from_standard_normal(z) / 1e307, expected, 1e-14) << z;
    EXPECT_NEAR(prior.to_standard_normal(prior.from_standard_normal(z)), z, 1e-9) << z;
  }
}

TEST(Prior, TableRejectsInvalidPoints) {
  const auto message = [](std::vector<double> x, std::vector<double> density) -> std::string {
    try {
      (void)TabulatedPrior(std::move(x), std::move(density));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message({0, 1, 1}, {1, 1, 1}),
            "table prior: x[2] = 1, must be greater than the previous value");
  EXPECT_EQ(message({0, 1, 2}, {1, -1, 1}),
            "table prior: density[1] = -1, must be >= 0 and finite");
  EXPECT_NE(message({0, 1, 2}, {1, 0, 1}).find("density[1] = 0"), std::string::npos);
  EXPECT_NE(message({0, 1}, {1}), "");
  EXPECT_NE(message({0}, {1}), "");
  EXPECT_NE(message({0, kNaN}, {1, 1}), "");
  EXPECT_NE(message({0, 1}, {0, 0}), "");
  EXPECT_NE(message({-1e308, 1e308}, {1, 1}), "");
  EXPECT_EQ(message({0, 1, 2}, {0, 1, 0}), "");
}

TEST(Prior, MomentsMatchQuadratureOverTheTransform) {
  for (const Prior& prior : every_family()) {
    double mean = 0.0, square = 0.0, weight = 0.0;
    const double centre = prior.mean();
    for (double z = -9.0; z <= 9.0; z += 0.01) {
      const double w = std::exp(-0.5 * z * z), d = prior.from_standard_normal(z) - centre;
      weight += w;
      mean += w * d;
      square += w * d * d;
    }
    EXPECT_NEAR(mean / weight, 0.0, 1e-6 * prior.sd()) << prior.describe();
    EXPECT_NEAR(std::sqrt(square / weight) / prior.sd(), 1.0, 1e-5) << prior.describe();
  }
}

TEST(Prior, DensityIsZeroOutsideTheSupport) {
  EXPECT_EQ(Prior(Uniform{0.0, 1.0}).log_density(1.0 + 1e-12), -kInfinity);
  EXPECT_EQ(Prior(HalfNormal{1.0}).log_density(-1e-12), -kInfinity);
  EXPECT_EQ(Prior(Gamma{2.0, 1.0}).log_density(-1.0), -kInfinity);
  EXPECT_EQ(Prior(TruncatedNormal{0.0, 1.0, -1.0, 1.0}).log_density(1.5), -kInfinity);
  EXPECT_EQ(Prior(Normal{0.0, 1.0}).log_density(kNaN), -kInfinity);
}

TEST(Prior, RejectsImproperDensitiesWithTheReason) {
  const auto message = [](const Prior::Family& family) -> std::string {
    try {
      (void)Prior(family);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message(Uniform{5.0, 2.0}), "uniform prior: lower = 5, must be < upper = 2");
  EXPECT_EQ(message(LogUniform{0.0, 2.0}), "log_uniform prior: lower = 0, must be > 0 and finite");
  const std::vector<Prior::Family> refused = {TruncatedNormal{1e300, 1e-300, 0.0, 1.0},
                                              TruncatedNormal{0.5, 1e-320, 1.0, kInfinity},
                                              Uniform{1.0, 1.0},
                                              Uniform{0.0, kInfinity},
                                              Uniform{kNaN, 1.0},
                                              Uniform{-1e308, 1e308},
                                              LogUniform{-1.0, 1.0},
                                              LogUniform{2.0, 1.0},
                                              LogUniform{1.0, kInfinity},
                                              Normal{0.0, 0.0},
                                              Normal{0.0, -1.0},
                                              Normal{kNaN, 1.0},
                                              Normal{0.0, kInfinity},
                                              LogNormal{0.0, 0.0},
                                              LogNormal{kInfinity, 1.0},
                                              HalfNormal{0.0},
                                              HalfNormal{kNaN},
                                              Gamma{0.0, 1.0},
                                              Gamma{1.0, -1.0},
                                              Gamma{kNaN, 1.0},
                                              Beta{0.0, 1.0},
                                              Beta{1.0, kInfinity},
                                              Beta{1.0, 1.0, 1.0, 0.0},
                                              InverseGamma{0.0, 1.0},
                                              InverseGamma{1.0, kInfinity},
                                              StudentT{0.0, 0.0, 1.0},
                                              StudentT{1.0, kNaN, 1.0},
                                              StudentT{1.0, 0.0, 0.0},
                                              OwnPrior{},
                                              TruncatedNormal{0.0, 0.0, 0.0, 1.0},
                                              TruncatedNormal{0.0, 1.0, 1.0, 1.0},
                                              TruncatedNormal{0.0, 1.0, kNaN, 1.0},
                                              TruncatedNormal{0.0, 1.0, kInfinity, kInfinity}};
  for (std::size_t i = 0; i < refused.size(); ++i) EXPECT_NE(message(refused[i]), "") << i;
  EXPECT_EQ(message(TruncatedNormal{0.0, 1.0, -kInfinity, kInfinity}), "");
}

TEST(Prior, DescribesItselfAsTheCaseFileWould) {
  EXPECT_EQ(Prior(Uniform{0.0, 100.0}).describe(), "uniform [0, 100]");
  EXPECT_EQ(Prior(LogUniform{1e-4, 0.01}).describe(), "log_uniform [0.0001, 0.01]");
  EXPECT_EQ(Prior(Beta{2.0, 3.0, 0.0, 0.6}).describe(), "beta [2, 3] on [0, 0.6]");
  EXPECT_EQ(Prior(InverseGamma{3.0, 0.5}).describe(), "inverse_gamma [3, 0.5]");
  EXPECT_EQ(Prior(StudentT{4.0, 0.0, 2.0}).describe(), "student_t [4, 0, 2]");
}

TEST(Prior, SlopeIsTheDerivativeOfTheTransform) {
  for (const Prior& prior : every_family()) {
    for (double z = -6.0; z <= 6.0; z += 0.37) {
      constexpr double kStep = 1e-3;
      const auto x = [&](double at) { return prior.from_standard_normal(at); };
      const double expected =
          (8.0 * (x(z + kStep) - x(z - kStep)) - (x(z + 2 * kStep) - x(z - 2 * kStep))) /
          (12.0 * kStep);
      // Rounding error of x divided by the step.
      const double rounding = 4e-15 * std::fabs(x(z)) / kStep;
      EXPECT_NEAR(prior.slope(z), expected, 1e-6 * expected + rounding)
          << prior.describe() << " at " << z;
    }
  }
}

// φ and p are both below the smallest double, and x equals its bound.
TEST(Prior, SlopeInTheTails) {
  EXPECT_NEAR(Prior(Normal{2.0, 0.5}).slope(-45.0), 0.5, 1e-12);
  EXPECT_NEAR(Prior(LogNormal{0.0, 1.0}).slope(-45.0) / std::exp(-45.0), 1.0, 1e-12);
  // dx/dz → scale · z for the exponential tail of a gamma, whose hazard is 1/scale there.
  EXPECT_NEAR(Prior(Gamma{1.0, 0.1}).slope(30.0) / (0.1 * 30.0), 1.0, 2e-3);
  // p(x) = 30 x^29, x = Φ(z)^(1/30): dx/dz = x φ(z) / (30 Φ(z)), the hazard again.
  const double x = std::exp(log_normal_cdf(-30.0) / 30.0);
  EXPECT_NEAR(Prior(Beta{30.0, 1.0}).slope(-30.0) / (x * 30.0 / 30.0), 1.0, 2e-3);
  for (const Prior& prior : every_family()) {
    for (const double z : {-100.0, -40.0, -9.0, 9.0, 40.0}) {
      const double slope = prior.slope(z);
      EXPECT_TRUE(std::isfinite(slope) && slope >= 0.0) << prior.describe() << " at " << z;
    }
  }
}

// Regression: upper / lower overflowed, and all results were NaN.
TEST(Prior, LogUniformMayBeginAtTheSmallestNumbers) {
  const double lower = 1e-320;
  const Prior prior = LogUniform{lower, 1.0};
  const double span = -std::log(lower);
  EXPECT_NEAR(prior.log_density(0.5), -std::log(span) - std::log(0.5), 1e-12);
  EXPECT_NEAR(prior.from_standard_normal(0.0), std::exp(-0.5 * span), 1e-9 * std::exp(-0.5 * span));
  for (const double z : {-8.0, -1.0, 0.0, 1.0, 8.0}) {
    const double x = prior.from_standard_normal(z);
    EXPECT_GE(x, lower);
    EXPECT_LE(x, 1.0);
    EXPECT_TRUE(std::isfinite(prior.slope(z)));
    if (std::abs(z) < 2.0) {
      EXPECT_NEAR(prior.to_standard_normal(x), z, 1e-9);
    }
  }
}

}  // namespace
}  // namespace wheeltap::inference
