#include "inference/mixtures/normal_mixture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

std::span<const double> view(const Eigen::VectorXd& z) {
  return {z.data(), static_cast<std::size_t>(z.size())};
}

NormalMixture random_mixture(int d, int components, std::uint64_t seed, double spread = 2.0,
                             double nu = kInfinity) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  std::vector<NormalMixture::Component> parts;
  for (int k = 0; k < components; ++k) {
    Eigen::VectorXd mean(d);
    Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(d, d);
    for (int i = 0; i < d; ++i) {
      mean[i] = spread * random.normal();
      factor(i, i) = 0.2 + random.uniform();
      for (int j = 0; j < i; ++j) factor(i, j) = 0.3 * random.normal();
    }
    parts.push_back({0.5 + random.uniform(), mean, factor});
  }
  return NormalMixture(parts, nu);
}

Eigen::MatrixXd draw(const NormalMixture& q, int n, base::Random& random) {
  Eigen::MatrixXd samples(n, q.dimension());
  std::vector<double> z(static_cast<std::size_t>(q.dimension()));
  for (int i = 0; i < n; ++i) {
    q.sample(random, z);
    for (int j = 0; j < q.dimension(); ++j) samples(i, j) = z[static_cast<std::size_t>(j)];
  }
  return samples;
}

/// Mean of ln p - ln q over draws from p: the Kullback-Leibler divergence, up to Monte Carlo error.
double divergence(const NormalMixture& p, const NormalMixture& q, int n, base::Random& random) {
  const Eigen::MatrixXd samples = draw(p, n, random);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd z = samples.row(i);
    sum += p.log_density(view(z)) - q.log_density(view(z));
  }
  return sum / n;
}

/// The defining formula, with a determinant and a solve.
double plain_log_density(const NormalMixture& q, const Eigen::VectorXd& z) {
  double sum = 0.0;
  const double d = q.dimension(), nu = q.degrees_of_freedom();
  for (int k = 0; k < q.size(); ++k) {
    const Eigen::MatrixXd s = q[k].factor * q[k].factor.transpose();
    const double form = (z - q[k].mean).dot(s.ldlt().solve(z - q[k].mean));
    const double det = s.determinant();
    if (std::isinf(nu)) {
      sum += q[k].weight * std::exp(-0.5 * form) / std::sqrt(std::pow(2.0 * M_PI, d) * det);
    } else {
      sum += q[k].weight * std::tgamma(0.5 * (nu + d)) /
             (std::tgamma(0.5 * nu) * std::sqrt(std::pow(nu * M_PI, d) * det)) *
             std::pow(1.0 + form / nu, -0.5 * (nu + d));
    }
  }
  return std::log(sum);
}

TEST(NormalMixture, LogDensityMatchesTheDefinition) {
  for (const double nu : {kInfinity, 5.0})
    for (const int d : {1, 2, 3, 4, 7, 16})
      for (const int components : {1, 7, 8, 9, 20}) {
        const NormalMixture q = random_mixture(d, components, 1, 1.0, nu);
        base::Random random(2, 0, 0, base::Purpose::test);
        const Eigen::MatrixXd samples = draw(q, 20, random);
        for (int i = 0; i < samples.rows(); ++i) {
          const Eigen::VectorXd z = samples.row(i);
          // Condition number of the random factors, to the power of the number of solves.
          EXPECT_NEAR(q.log_density(view(z)), plain_log_density(q, z), 1e-9 * d)
              << d << " dimensions, " << components << " components, nu " << nu;
          std::vector<double> parts(static_cast<std::size_t>(components));
          q.component_log_densities(view(z), parts);
          double sum = 0.0;
          for (const double p : parts) sum += std::exp(p);
          EXPECT_NEAR(std::log(sum), q.log_density(view(z)), 1e-12);
        }
      }
}

TEST(NormalMixture, IntegratesToOne) {
  // The trapezoid rule is spectrally accurate here; for t_5 in one dimension the tail beyond 400
  // has a mass of order 400⁻⁵.
  for (const double nu : {kInfinity, 5.0}) {
    const NormalMixture q = random_mixture(1, 5, 3, 2.0, nu);
    double sum = 0.0;
    const double step = 0.01;
    for (double z = -400.0; z <= 400.0; z += step) sum += step * std::exp(q.log_density({&z, 1}));
    EXPECT_NEAR(sum, 1.0, 1e-9) << nu;
  }
  const NormalMixture q = random_mixture(2, 4, 4);
  double sum = 0.0;
  const double step = 0.04;
  for (double x = -12.0; x <= 12.0; x += step)
    for (double y = -12.0; y <= 12.0; y += step) {
      const std::vector<double> z = {x, y};
      sum += step * step * std::exp(q.log_density(z));
    }
  EXPECT_NEAR(sum, 1.0, 1e-8);
}

// If draws come from q and its density is correct, E_q[p/q] = 1 for any density p inside q. The
// tolerance is 4 standard errors from the draws, which must be small.
TEST(NormalMixture, SamplesFollowItsDensity) {
  for (const double nu : {kInfinity, 4.0})
    for (const int d : {1, 3, 6}) {
      const NormalMixture q = random_mixture(d, 6, 5, 1.0, nu);
      std::vector<NormalMixture::Component> narrow;
      for (int k = 0; k < q.size(); ++k)
        narrow.push_back({1.0, q[k].mean + 0.1 * q[k].factor.col(0), 0.8 * q[k].factor});
      const NormalMixture p(narrow);
      base::Random random(6, 0, 0, base::Purpose::test);
      constexpr int kDraws = 40000;
      const Eigen::MatrixXd samples = draw(q, kDraws, random);
      double mean = 0.0, square = 0.0;
      for (int i = 0; i < kDraws; ++i) {
        const Eigen::VectorXd z = samples.row(i);
        const double w = std::exp(p.log_density(view(z)) - q.log_density(view(z)));
        mean += w / kDraws;
        square += w * w / kDraws;
      }
      const double error = std::sqrt((square - mean * mean) / kDraws);
      EXPECT_NEAR(mean, 1.0, 4.0 * error) << d << " dimensions, nu " << nu;
      EXPECT_LT(error, 0.02);
    }
}

TEST(NormalMixture, DensityIsSmallAndNeverNaNFarAway) {
  const NormalMixture q = random_mixture(2, 3, 7);
  const std::vector<double> far = {1e3, -1e3}, absurd = {1e200, 0.0}, infinite = {kInfinity, 0.0},
                            broken = {std::nan(""), 0.0};
  EXPECT_LT(q.log_density(far), -1e4);
  EXPECT_TRUE(std::isfinite(q.log_density(far)));
  EXPECT_EQ(q.log_density(absurd), -kInfinity);
  EXPECT_EQ(q.log_density(infinite), -kInfinity);
  EXPECT_EQ(q.log_density(broken), -kInfinity);
}

TEST(NormalMixture, StandardisesByEachComponent) {
  const NormalMixture q = random_mixture(3, 2, 8);
  const std::vector<double> z = {0.3, -1.2, 0.7};
  std::vector<double> u(3), back(3);
  q.standardise(1, z, u);
  q.unstandardise(1, u, back);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back[i], z[i], 1e-14);
  std::vector<double> parts(2);
  q.component_log_densities(z, parts);
  const double standard = -0.5 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) - 3.0 * kLogSqrt2Pi;
  EXPECT_NEAR(parts[1], std::log(q[1].weight) + standard - q.log_determinant(1), 1e-12);
}

// The divergence of a fit with the correct number of components to n samples is about parameters /
// (2n).
TEST(NormalMixtureFit, RecoversTheMixtureOfItsSamples) {
  constexpr int kSamples = 5000;
  for (const int d : {1, 2, 4, 6})
    for (const int components : {1, 4}) {
      const NormalMixture truth = random_mixture(d, components, 9, 3.0);
      base::Random random(10, 0, 0, base::Purpose::test);
      NormalMixture::FitOptions options;
      options.defensive_weight = 0.0;
      const NormalMixture q = NormalMixture::fit(draw(truth, kSamples, random), options, random);
      const double parameters = components * (1.0 + d + 0.5 * d * (d + 1.0)) - 1.0;
      EXPECT_LE(q.size(), components) << d;
      EXPECT_LT(divergence(truth, q, 20000, random), 4.0 * parameters / (2.0 * kSamples) + 0.005)
          << d << " dimensions, " << components << " components";
    }
}

TEST(NormalMixtureFit, FindsManyComponents) {
  const NormalMixture truth = random_mixture(4, 20, 1);
  base::Random random(11, 0, 0, base::Purpose::test);
  const NormalMixture q = NormalMixture::fit(draw(truth, 5000, random), random);
  EXPECT_LT(divergence(truth, q, 20000, random), 0.1);
}

TEST(NormalMixtureFit, SymmetricModesGetEqualWeights) {
  // Two narrow mirror modes, as of a damage at x and L - x: 1 % of their distance wide.
  std::vector<NormalMixture::Component> modes;
  for (const double sign : {-1.0, 1.0})
    modes.push_back({1.0, sign * Eigen::VectorXd::Ones(2), 0.02 * Eigen::MatrixXd::Identity(2, 2)});
  const NormalMixture truth(modes);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    base::Random random(seed, 0, 0, base::Purpose::test);
    constexpr int kSamples = 4000;
    const NormalMixture q = NormalMixture::fit(draw(truth, kSamples, random), random);
    ASSERT_EQ(q.size(), 3);
    double left = 0.0;
    for (int k = 0; k < 2; ++k) {
      if (q[k].mean[0] < 0.0) left += q[k].weight;
      EXPECT_NEAR(std::fabs(q[k].mean[0]), 1.0, 0.005);
      EXPECT_NEAR(q[k].factor(0, 0), 0.02, 0.002);
    }
    const double error = std::sqrt(0.25 / kSamples);
    EXPECT_NEAR(left / 0.98, 0.5, 4.0 * error);
  }
}

TEST(NormalMixtureFit, FollowsABanana) {
  base::Random random(12, 0, 0, base::Purpose::test);
  Eigen::MatrixXd samples(4000, 2);
  std::vector<double> log_p;
  for (int i = 0; i < samples.rows(); ++i) {
    const double x = random.normal(), e = 0.1 * random.normal();
    samples.row(i) << x, x * x - 1.0 + e;
    log_p.push_back(-0.5 * x * x - 50.0 * e * e - 2.0 * kLogSqrt2Pi - std::log(0.1));
  }
  const auto loss = [&](const NormalMixture& q) {
    double sum = 0.0;
    for (int i = 0; i < samples.rows(); ++i) {
      const Eigen::VectorXd z = samples.row(i);
      sum += log_p[static_cast<std::size_t>(i)] - q.log_density(view(z));
    }
    return sum / static_cast<double>(samples.rows());
  };
  NormalMixture::FitOptions one;
  one.max_components = 1;
  EXPECT_GT(loss(NormalMixture::fit(samples, one, random)), 1.5);
  EXPECT_LT(loss(NormalMixture::fit(samples, random)), 0.15);
}

TEST(NormalMixtureFit, DoesNotDependOnUnits) {
  // Scaling by powers of two is exact, so that the fits must be equal.
  const NormalMixture truth = random_mixture(3, 3, 13);
  base::Random random(14, 0, 0, base::Purpose::test);
  const Eigen::MatrixXd samples = draw(truth, 2000, random);
  const Eigen::Vector3d units(1024.0, 1.0, 1.0 / 4096.0);
  NormalMixture::FitOptions options;
  options.defensive_weight = 0.0;
  base::Random first(15, 0, 0, base::Purpose::fit), second(15, 0, 0, base::Purpose::fit);
  const NormalMixture a = NormalMixture::fit(samples, options, first);
  const NormalMixture b = NormalMixture::fit(samples * units.asDiagonal(), options, second);
  ASSERT_EQ(a.size(), b.size());
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd z = samples.row(i);
    const Eigen::VectorXd scaled = units.cwiseProduct(z);
    EXPECT_NEAR(a.log_density(view(z)), b.log_density(view(scaled)) + std::log(units.prod()), 1e-6);
  }
}

TEST(NormalMixtureFit, HandlesOrderedAndRepeatedSamples) {
  const NormalMixture truth = random_mixture(2, 2, 16);
  base::Random random(17, 0, 0, base::Purpose::test);
  const Eigen::MatrixXd samples = draw(truth, 1000, random);
  base::Random first(18, 0, 0, base::Purpose::fit), second(18, 0, 0, base::Purpose::fit);
  const NormalMixture a = NormalMixture::fit(samples, first);
  const NormalMixture b = NormalMixture::fit(samples.colwise().reverse(), second);
  const Eigen::VectorXd z = samples.row(3);
  EXPECT_EQ(a.log_density(view(z)), b.log_density(view(z)));
  // A chain that repeated its state 200 times: a spike there would have an unbounded likelihood.
  Eigen::MatrixXd sticky(1200, 2);
  sticky.topRows(1000) = samples;
  sticky.bottomRows(200).rowwise() = samples.row(3);
  const NormalMixture c = NormalMixture::fit(sticky, random);
  EXPECT_LT(c.log_density(view(z)), a.log_density(view(z)) + std::log(100.0));
}

TEST(NormalMixtureFit, GivesADensityForFewOrDegenerateSamples) {
  base::Random random(19, 0, 0, base::Purpose::test);
  Eigen::MatrixXd one(1, 3), same = Eigen::MatrixXd::Constant(50, 3, 0.25), flat(100, 3);
  one << 1.0, 2.0, 3.0;
  for (int i = 0; i < 100; ++i) flat.row(i) << random.normal(), random.normal(), 0.5;
  for (const Eigen::MatrixXd& samples : {one, same, flat}) {
    const NormalMixture q = NormalMixture::fit(samples, random);
    const Eigen::VectorXd z = samples.row(0);
    EXPECT_TRUE(std::isfinite(q.log_density(view(z))));
    const Eigen::VectorXd elsewhere = Eigen::VectorXd::Zero(3);
    EXPECT_GE(q.log_density(view(elsewhere)), std::log(0.02) - 3.0 * kLogSqrt2Pi - 1e-12);
  }
}

TEST(NormalMixtureFit, RejectsInvalidInput) {
  base::Random random(20, 0, 0, base::Purpose::test);
  Eigen::MatrixXd samples = Eigen::MatrixXd::Random(50, 2);
  NormalMixture::FitOptions options;
  EXPECT_THROW((void)NormalMixture::fit(Eigen::MatrixXd(0, 2), random), std::invalid_argument);
  options.max_components = 0;
  EXPECT_THROW((void)NormalMixture::fit(samples, options, random), std::invalid_argument);
  options = {};
  options.defensive_weight = 1.0;
  EXPECT_THROW((void)NormalMixture::fit(samples, options, random), std::invalid_argument);
  samples(7, 1) = std::nan("");
  EXPECT_THROW((void)NormalMixture::fit(samples, random), std::invalid_argument);
  EXPECT_THROW(NormalMixture({}), std::invalid_argument);
  EXPECT_THROW(NormalMixture({{0.0, Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1)}}),
               std::invalid_argument);
  EXPECT_THROW(NormalMixture({{1.0, Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Zero(1, 1)}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
