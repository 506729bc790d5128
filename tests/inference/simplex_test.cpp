// Dirichlet density by stick breaking, against its moments and its formula.
#include "inference/model/simplex.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

const std::vector<double> kAlpha = {0.7, 2.0, 4.3};

TEST(Simplex, BreaksSharesOffBySticks) {
  const Simplex simplex("w", kAlpha);
  EXPECT_EQ(simplex.size(), 3);
  EXPECT_EQ(simplex.names(), (std::vector<std::string>{"w[1]", "w[2]"}));
  const auto shares = simplex.shares(std::vector<double>{0.25, 0.4});
  EXPECT_NEAR(shares[0], 0.25, 1e-15);
  EXPECT_NEAR(shares[1], 0.3, 1e-15);
  EXPECT_NEAR(shares[2], 0.45, 1e-15);
}

// ∏ p(v_i) |∂v/∂w| is Dirichlet's density: Γ(Σα) ∏ w_i^(α_i - 1)/Γ(α_i).
TEST(Simplex, HasTheDirichletDensity) {
  const Simplex simplex("w", kAlpha);
  for (const double a : {0.05, 0.3, 0.8}) {
    for (const double b : {0.1, 0.5, 0.95}) {
      const std::vector<double> v = {a, b};
      const auto w = simplex.shares(v);
      double by_sticks = -std::log(1.0 - a);  // ∂(w_1, w_2)/∂(v_1, v_2) = 1 - v_1
      for (std::size_t i = 0; i < 2; ++i) by_sticks += simplex.sticks()[i].prior.log_density(v[i]);
      double expected = std::lgamma(kAlpha[0] + kAlpha[1] + kAlpha[2]);
      for (std::size_t i = 0; i < 3; ++i)
        expected += (kAlpha[i] - 1.0) * std::log(w[i]) - std::lgamma(kAlpha[i]);
      EXPECT_NEAR(by_sticks, expected, 1e-12) << a << " " << b;
    }
  }
}

// E w_i = α_i/Σα, to 4.5 standard errors of 20 000 draws.
TEST(Simplex, HasTheDirichletMeans) {
  const Simplex simplex("w", kAlpha);
  base::Random random(3, 0, 0, base::Purpose::test);
  constexpr int kDraws = 20000;
  std::vector<double> sum(3, 0.0);
  for (int n = 0; n < kDraws; ++n) {
    std::vector<double> v;
    for (const Parameter& stick : simplex.sticks())
      v.push_back(stick.prior.from_standard_normal(random.normal()));
    const auto w = simplex.shares(v);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += w[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double mean = kAlpha[i] / 7.0, sd = std::sqrt(mean * (1.0 - mean) / 8.0);
    EXPECT_NEAR(sum[i] / kDraws, mean, 4.5 * sd / std::sqrt(kDraws));
  }
}

TEST(Simplex, RejectsInvalidInput) {
  EXPECT_THROW(Simplex("w", {1.0}), std::invalid_argument);
  EXPECT_THROW(Simplex("w", {1.0, 0.0}), std::invalid_argument);
  const Simplex simplex("w", kAlpha);
  EXPECT_THROW((void)simplex.shares(std::vector<double>{0.5}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
