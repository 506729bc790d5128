#include "identification/structural/likelihood/mode_contributions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::identification {
namespace {

double log_normal_density(const Eigen::VectorXd& r, const Eigen::MatrixXd& c) {
  return -0.5 * r.dot(c.inverse() * r) - 0.5 * std::log((2.0 * std::numbers::pi * c).determinant());
}

TEST(ModeContributions, OneModeGivenTheOthersIsTheRatioOfJointDensities) {
  ModalData data;
  data.frequencies_hz = {10.0, std::nan(""), 20.0, 31.0};
  ModalLikelihood::Score score;
  for (const double f : {10.2, 15.0, 19.5, 31.1}) {
    score.matches.emplace_back();
    score.matches.back().frequency_hz = f;
  }
  Eigen::MatrixXd c(3, 3);
  c << 0.04, 0.02, 0.01, 0.02, 0.09, 0.03, 0.01, 0.03, 0.16;
  const Eigen::VectorXd r = Eigen::Vector3d(-0.2, 0.5, -0.1);
  const Eigen::VectorXd l = single_mode_densities(data, {0, 2, 3}, c, score);
  ASSERT_EQ(l.size(), 4);
  EXPECT_EQ(l[1], 0.0);
  const std::vector<int> places = {0, 2, 3};
  for (int k = 0; k < 3; ++k) {
    std::vector<int> others;
    for (int o = 0; o < 3; ++o)
      if (o != k) others.push_back(o);
    EXPECT_NEAR(l[places[static_cast<std::size_t>(k)]],
                log_normal_density(r, c) - log_normal_density(r(others), c(others, others)), 1e-12);
  }
}

// x ~ N(0, 1), two measurements y = x + e with variances s and t: all posteriors are normal, and
// KL(N(a, u) ‖ N(b, v)) = ½ (u/v - 1 - ln(u/v) + (a - b)²/v).
TEST(ModeContributions, InformationIsTheDivergence) {
  const double y = 1.0, z = 0.4, s = 0.5, t = 2.0;
  const double u = 1.0 / (1.0 + 1.0 / s + 1.0 / t), a = u * (y / s + z / t);
  const double v = 1.0 / (1.0 + 1.0 / s), b = v * y / s;
  const double exact = 0.5 * (u / v - 1.0 - std::log(u / v) + (a - b) * (a - b) / v);
  base::Random random(3, 0, 0, base::Purpose::test);
  constexpr int kDraws = 200'000;
  std::vector<double> x, l;
  for (int i = 0; i < kDraws; ++i) {
    x.push_back(a + std::sqrt(u) * random.normal());
    l.push_back(-0.5 * (z - x.back()) * (z - x.back()) / t);
  }
  const WithoutMode out = without_mode(l);
  EXPECT_TRUE(out.reliable);
  double mean = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) mean += out.weights[i] * x[i];
  // Five standard errors; the effective number of draws for weights of a wider normal is half.
  EXPECT_NEAR(mean, b, 5.0 * std::sqrt(v / (0.5 * kDraws)));
  EXPECT_NEAR(out.information, exact, 5.0 / std::sqrt(static_cast<double>(kDraws)));

  // A draw of weight two equals two draws.
  const std::vector<double> once = {-1.0, -2.0, -2.0}, twice = {-1.0, -2.0};
  const WithoutMode plain = without_mode(once),
                    weighted = without_mode(twice, std::vector{1.0, 2.0});
  EXPECT_NEAR(plain.information, weighted.information, 1e-12);
  EXPECT_NEAR(plain.weights[0], weighted.weights[0], 1e-12);
  EXPECT_FALSE(plain.reliable) << "three draws";
}

}  // namespace
}  // namespace wheeltap::identification
