// The packed routines against plain loops over the formulas in their header.
#include "inference/mixtures/packed_mixture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference::packed::packed_mixture_test {
namespace {

using Component = NormalMixture::Component;

constexpr double kRounding = 1e-12;  // relative; sums of some hundred terms

// Full groups, one short of full, one more, and a single one.
const std::vector<int> kCounts = {1, 7, 8, 9, 17};

std::vector<Component> components(int d, int count, base::Random& random) {
  std::vector<Component> out;
  for (int k = 0; k < count; ++k) {
    Component c{.weight = 0.1 + random.uniform(),
                .mean = Eigen::VectorXd(d),
                .factor = Eigen::MatrixXd::Zero(d, d)};
    for (int i = 0; i < d; ++i) {
      c.mean[i] = random.normal();
      for (int j = 0; j < i; ++j) c.factor(i, j) = 0.4 * random.normal();
      c.factor(i, i) = 0.5 + random.uniform();
    }
    out.push_back(std::move(c));
  }
  return out;
}

Eigen::VectorXd place(int d, base::Random& random) {
  return Eigen::VectorXd::NullaryExpr(d, [&] { return 2.0 * random.normal(); });
}

double quadratic_form(const Component& c, const Eigen::VectorXd& z) {
  return c.factor.triangularView<Eigen::Lower>().solve(z - c.mean).squaredNorm();
}

double log_weighted_density(const Component& c, const Eigen::VectorXd& z) {
  return std::log(c.weight) - static_cast<double>(z.size()) * kLogSqrt2Pi -
         log_sum_diagonal(c.factor) - 0.5 * quadratic_form(c, z);
}

double log_density(const std::vector<double>& packed, std::size_t count, const Eigen::VectorXd& z) {
  const auto d = static_cast<std::size_t>(z.size());
  return routines().log_density(packed.data(), groups_of(count), group_stride(d), z.data(), d);
}

template <class Check>
void for_each_size(const Check& check) {
  base::Random random(61, 0, 0, base::Purpose::test);
  for (int d = 1; d <= 6; ++d) {
    for (const int count : kCounts) {
      SCOPED_TRACE(std::to_string(count) + " components in " + std::to_string(d) + "-d");
      check(d, components(d, count, random), random);
    }
  }
}

// Regression: with contraction to fused multiply-add, a chain's draws differed between processors.
TEST(PackedMixture, EveryInstructionSetGivesTheSameBits) {
  const auto all = runnable_routines(base::Instructions::automatic);
  for_each_size([&](int d, const std::vector<Component>& parts, base::Random& random) {
    const auto packed = pack(parts, kInfinity);
    const std::size_t groups = groups_of(parts.size()),
                      stride = group_stride(static_cast<std::size_t>(d));
    const auto bits = [&](const Routines& routines, const Eigen::VectorXd& z) {
      std::vector<double> out(groups * kLanes);
      routines.quadratic_forms(packed.data(), groups, stride, z.data(), static_cast<std::size_t>(d),
                               out.data());
      out.push_back(routines.log_density(packed.data(), groups, stride, z.data(),
                                         static_cast<std::size_t>(d)));
      const std::vector<double> means(groups * kLanes * static_cast<std::size_t>(d), 0.25);
      std::vector<double> moments(groups * (stride + kLanes), 0.0);
      const double weight = 0.7;
      out.push_back(routines.em_pass(packed.data(), means.data(), groups, stride,
                                     {1, static_cast<std::size_t>(d), z.data(), &weight},
                                     moments.data()));
      out.insert(out.end(), moments.begin(), moments.end());
      return out;
    };
    for (int i = 0; i < 20; ++i) {
      const Eigen::VectorXd z = place(d, random);
      const auto expected = bits(*all.front(), z);
      for (const Routines* routines : all) EXPECT_EQ(bits(*routines, z), expected);
    }
  });
}

TEST(PackedMixture, LogDensityMatchesThePlainSum) {
  for_each_size([](int d, const std::vector<Component>& parts, base::Random& random) {
    const auto packed = pack(parts, kInfinity);
    for (int i = 0; i < 20; ++i) {
      const Eigen::VectorXd z = place(d, random);
      double sum = 0.0;
      for (const Component& c : parts) sum += std::exp(log_weighted_density(c, z));
      const double expected = std::log(sum);
      EXPECT_NEAR(log_density(packed, parts.size(), z), expected,
                  kRounding * (1.0 + std::fabs(expected)));
    }
  });
}

TEST(PackedMixture, DoesNotUnderflowFarFromEveryComponent) {
  base::Random random(62, 0, 0, base::Purpose::test);
  const auto parts = components(2, 9, random);
  const auto packed = pack(parts, kInfinity);
  const Eigen::VectorXd far = Eigen::VectorXd::Constant(2, 1e4);
  double top = -kInfinity;
  for (const Component& c : parts) top = std::max(top, log_weighted_density(c, far));
  ASSERT_LT(top, -1e7);
  EXPECT_NEAR(log_density(packed, parts.size(), far) / top, 1.0, kRounding);
}

TEST(PackedMixture, PacksTheNormaliserOfStudentsTIfRequested) {
  // d = 1, one component, ν = 3: c = ln Γ(2) - ln Γ(3/2) - ½ ln (3 π) - ln σ.
  const Component c{.weight = 1.0,
                    .mean = Eigen::VectorXd::Constant(1, 0.3),
                    .factor = Eigen::MatrixXd::Constant(1, 1, 2.0)};
  const double expected =
      std::lgamma(2.0) - std::lgamma(1.5) - 0.5 * std::log(3.0 * M_PI) - std::log(2.0);
  EXPECT_NEAR(pack({c}, 3.0)[0], expected, kRounding);
}

TEST(PackedMixture, QuadraticFormsMatchEachComponent) {
  for_each_size([](int d, const std::vector<Component>& parts, base::Random& random) {
    const auto packed = pack(parts, kInfinity);
    const Eigen::VectorXd z = place(d, random);
    std::vector<double> values(groups_of(parts.size()) * kLanes);
    const auto dimension = static_cast<std::size_t>(d);
    routines().quadratic_forms(packed.data(), groups_of(parts.size()), group_stride(dimension),
                               z.data(), dimension, values.data());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const double expected = quadratic_form(parts[k], z);
      EXPECT_NEAR(values[k], expected, kRounding * (1.0 + expected)) << "component " << k;
    }
  });
}

// Moments of a component as the header lists them, by plain loops.
std::vector<double> plain_moments(const std::vector<Component>& parts, std::size_t k,
                                  const Eigen::MatrixXd& z, const std::vector<double>& weight) {
  const auto d = static_cast<std::size_t>(z.cols());
  std::vector<double> out(2 + d + d * (d + 1) / 2);
  for (Eigen::Index n = 0; n < z.rows(); ++n) {
    const Eigen::VectorXd at = z.row(n);
    double all = 0.0;
    for (const Component& c : parts) all += std::exp(log_weighted_density(c, at));
    const double r = std::exp(log_weighted_density(parts[k], at)) / all;
    const double wr = r * weight[static_cast<std::size_t>(n)];
    out[0] += wr;
    out[1] += r;
    std::size_t next = 2;
    for (Eigen::Index i = 0; i < z.cols(); ++i) {
      const double e = at[i] - parts[k].mean[i];
      out[next++] += wr * e;
      for (Eigen::Index j = 0; j <= i; ++j) out[next++] += wr * e * (at[j] - parts[k].mean[j]);
    }
  }
  return out;
}

TEST(PackedMixture, EmPassSumsTheMomentsOfEachComponent) {
  for_each_size([](int dimension, const std::vector<Component>& parts, base::Random& random) {
    constexpr std::size_t kSamples = 50;
    const auto d = static_cast<std::size_t>(dimension);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> z(kSamples, dimension);
    std::vector<double> weight(kSamples);
    for (std::size_t n = 0; n < kSamples; ++n) {
      z.row(static_cast<Eigen::Index>(n)) = place(dimension, random);
      weight[n] = random.uniform();
    }
    const std::size_t groups = groups_of(parts.size()), stride = group_stride(d);
    const auto packed = pack(parts, kInfinity);
    std::vector<double> means(groups * kLanes * d), moments(groups * (stride + kLanes));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      for (std::size_t i = 0; i < d; ++i) {
        means[((k / kLanes) * d + i) * kLanes + k % kLanes] =
            parts[k].mean[static_cast<Eigen::Index>(i)];
      }
    }
    const Samples samples{kSamples, d, z.data(), weight.data()};
    const double log_likelihood =
        routines().em_pass(packed.data(), means.data(), groups, stride, samples, moments.data());
    double expected = 0.0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      const Eigen::VectorXd at = z.row(static_cast<Eigen::Index>(n));
      double all = 0.0;
      for (const Component& c : parts) all += std::exp(log_weighted_density(c, at));
      expected += weight[n] * std::log(all);
    }
    EXPECT_NEAR(log_likelihood / expected, 1.0, kRounding);
    // Groups with responsibilities below 1e-12 omit the sample: 50 samples whose deviations
    // multiply to 100 at most.
    constexpr double kLeftOut = 5e-9;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto plain = plain_moments(parts, k, z, weight);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        const double found = moments[(k / kLanes) * (stride + kLanes) + i * kLanes + k % kLanes];
        EXPECT_NEAR(found, plain[i], kLeftOut * (1.0 + std::fabs(plain[i])))
            << "component " << k << ", moment " << i;
      }
    }
  });
}

}  // namespace
}  // namespace wheeltap::inference::packed::packed_mixture_test
