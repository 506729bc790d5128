#include "inference/evidence/approximate_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/inference/statistics.hpp"

namespace wheeltap::inference {
namespace {

using Kind = SweepProposal::Kind;

// A mixture that differs from the target N(0, I) in three dimensions.
NormalMixture mixture() {
  Eigen::MatrixXd skew = Eigen::MatrixXd::Identity(3, 3);
  skew(1, 0) = 0.7;
  return NormalMixture({{0.6, Eigen::Vector3d(0.5, 0.0, -0.3), 0.8 * skew},
                        {0.4, Eigen::Vector3d(-0.4, 0.2, 0.0), 1.3 * skew}});
}

// p-value of the radii after Metropolis steps from exact draws of N(0, I), against other exact
// draws. If `corrected` is false, the steps ignore the ratio of proposal densities.
double radius_p_value(Kind kind, bool corrected) {
  constexpr int kDraws = 4000, kSteps = 12;
  const NormalMixture q = mixture();
  const SweepProposal propose{.mixture = q, .kind = kind, .scale = 0.8};
  std::vector<double> moved, exact, normal(3), to(3);
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    base::Random random(11, static_cast<std::uint64_t>(kind), i, base::Purpose::test);
    const auto draw = [&] {
      return std::vector<double>{random.normal(), random.normal(), random.normal()};
    };
    const auto square = [](const std::vector<double>& z) {
      return z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
    };
    std::vector<double> z = draw();
    for (int step = 0; step < kSteps; ++step) {
      const double log_ratio = propose(z, random, normal, to);
      const double log_target = 0.5 * (square(z) - square(to));
      if (std::log(random.uniform()) < log_target + (corrected ? log_ratio : 0.0)) z = to;
    }
    moved.push_back(std::sqrt(square(z)));
    exact.push_back(std::sqrt(square(draw())));
  }
  return two_sample_p_value(moved, exact);
}

TEST(SweepProposal, LeavesTheTargetInvariant) {
  for (const Kind kind : {Kind::renewal, Kind::walk, Kind::contraction})
    EXPECT_GT(radius_p_value(kind, true), 1e-4) << static_cast<int>(kind);
  for (const Kind kind : {Kind::renewal, Kind::contraction})
    EXPECT_LT(radius_p_value(kind, false), 1e-6) << static_cast<int>(kind);
}

// For a target equal to the mixture, every renewal and contraction is accepted, and a contraction
// of scale s has the correlation √(1 - s²) between u before and after.
TEST(SweepProposal, ContractionsLeaveTheMixtureInvariant) {
  constexpr double kScale = 0.6;
  const NormalMixture q({{1.0, Eigen::Vector2d(1.0, 2.0), 0.5 * Eigen::Matrix2d::Identity()}});
  const SweepProposal propose{.mixture = q, .kind = Kind::contraction, .scale = kScale};
  std::vector<double> z(2), normal(2), to(2);
  double product = 0.0;
  constexpr int kDraws = 20000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    base::Random random(12, 0, i, base::Purpose::test);
    q.sample(random, z);
    const double log_ratio = propose(z, random, normal, to);
    EXPECT_NEAR(log_ratio, q.log_density(z) - q.log_density(to), 1e-12);
    product += (z[0] - 1.0) * (to[0] - 1.0) / 0.25;
  }
  // The standard error of the mean product is about √((1 + ρ²)/n) = 0.009.
  EXPECT_NEAR(product / kDraws, std::sqrt(1.0 - kScale * kScale), 0.05);
}

}  // namespace
}  // namespace wheeltap::inference
