#include "signals/modal/free_decay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;

/// Displacements after each mode received a random velocity, with white noise.
Eigen::MatrixXd decay(const VibratingStructure& s, Index samples, double noise,
                      std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  const VibratingStructure::Modes modes = s.modes();
  const Index n = modes.frequencies_hz.size();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, samples);
  for (Index m = 0; m < n; ++m) {
    const double omega = kTwoPi * modes.frequencies_hz[m], amplitude = 1.0 + random.uniform();
    const double damped = omega * std::sqrt(1.0 - s.damping_ratio * s.damping_ratio);
    for (Index k = 0; k < samples; ++k) {
      const double t = s.step * static_cast<double>(k);
      out.col(k) += amplitude * std::exp(-s.damping_ratio * omega * t) * std::sin(damped * t) *
                    modes.shapes.col(m);
    }
  }
  for (double& x : out.reshaped()) x += noise * random.normal();
  return out;
}

TEST(FreeDecay, IsExactWithoutNoise) {
  const VibratingStructure s = chain(3, 1.0, 400.0);
  const VibratingStructure::Modes truth = s.modes();
  const ModalResult found = identify_decays({decay(s, 300, 1e-10, 1)},
                                            {.sample_rate_hz = 1.0 / s.step, .largest_order = 12});
  ASSERT_EQ(found.modes.size(), 3U);
  for (Index m = 0; m < 3; ++m) {
    const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
    EXPECT_NEAR(p.frequency_hz / truth.frequencies_hz[m], 1.0, 1e-8);
    EXPECT_NEAR(p.damping, s.damping_ratio, 1e-8);
    EXPECT_GT(modal_assurance(p.shape, truth.shapes.col(m).cast<std::complex<double>>()),
              1.0 - 1e-6);
  }
}

// Over many realisations, for one decay and for two together.
TEST(FreeDecay, CovarianceMatchesTheErrors) {
  const VibratingStructure s = chain(3, 1.0, 400.0);
  const VibratingStructure::Modes truth = s.modes();
  for (const std::size_t events : {1, 2}) {
    constexpr int kRuns = 30;
    double f = 0.0, zeta = 0.0;
    int modes = 0;
    for (int run = 0; run < kRuns; ++run) {
      std::vector<Eigen::MatrixXd> decays;
      for (std::size_t e = 0; e < events; ++e)
        decays.push_back(decay(s, 400, 0.02, 100 + 10 * static_cast<std::uint64_t>(run) + e));
      const ModalResult found =
          identify_decays(decays, {.sample_rate_hz = 1.0 / s.step, .lowest_hz = 0.5});
      ASSERT_EQ(found.modes.size(), 3U) << run;
      for (Index m = 0; m < 3; ++m) {
        const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
        f += std::pow((p.frequency_hz - truth.frequencies_hz[m]) / p.frequency_sd, 2);
        zeta += std::pow((p.damping - s.damping_ratio) / p.damping_sd, 2);
        ++modes;
      }
    }
    // 90 squares: standard error .15; of 300 they are 1.18 and 1.18 for one decay, 1.15 and .98 for
    // two.
    std::printf("  %zu decays: mean square errors over predicted: f %.2f, damping %.2f\n", events,
                f / modes, zeta / modes);
    EXPECT_NEAR(f / modes, 1.15, 0.45);
    EXPECT_NEAR(zeta / modes, 1.15, 0.45);
  }
}

// Regression: the filter of the decimation distorted the start of each decay by up to six standard
// deviations of the result.
TEST(FreeDecay, DecimationDoesNotMoveTheModes) {
  constexpr double kRate = 1000.0, kDamping = 0.01, kFirst = 3.0, kSecond = 9.4;
  base::Random random(4, 0, 0, base::Purpose::test);
  std::vector<Eigen::MatrixXd> decays;
  for (int e = 0; e < 8; ++e) {
    Eigen::MatrixXd y(2, 3000);
    for (Index k = 0; k < y.cols(); ++k) {
      const auto mode = [&](double hz) {
        const double t = static_cast<double>(k) / kRate, omega = kTwoPi * hz;
        return std::exp(-kDamping * omega * t) *
               std::cos(std::sqrt(1.0 - kDamping * kDamping) * omega * t);
      };
      y(0, k) = mode(kFirst) + 0.6 * mode(kSecond) + 0.01 * random.normal();
      y(1, k) = 0.5 * mode(kFirst) - mode(kSecond) + 0.01 * random.normal();
    }
    decays.push_back(std::move(y));
  }
  const ModalResult found =
      identify_decays(decays, {.sample_rate_hz = kRate, .lowest_hz = 1.0, .highest_hz = 10.0});
  EXPECT_GT(found.decimated, 1);
  ASSERT_EQ(found.modes.size(), 2U);
  for (const auto& [mode, hz] : {std::pair{0U, kFirst}, std::pair{1U, kSecond}}) {
    const Pole& p = found.modes[mode].pole;
    EXPECT_LT(std::abs(p.frequency_hz - hz), 4.0 * p.frequency_sd);
    EXPECT_LT(std::abs(p.damping - kDamping), 4.0 * p.damping_sd);
  }
}

// Regression: pure noise led to the factorisation of an empty matrix.
TEST(FreeDecay, FindsNoModesInNoise) {
  base::Random random(8, 0, 0, base::Purpose::test);
  Eigen::MatrixXd noise(2, 1000);
  for (double& x : noise.reshaped()) x = random.normal();
  const ModalResult found =
      identify_decays({noise, 2.0 * noise.colwise().reverse()}, {.sample_rate_hz = 20.0});
  EXPECT_TRUE(found.modes.empty());
  EXPECT_EQ(found.covariance.size(), 0);
}

TEST(FreeDecay, RejectsMisuse) {
  const VibratingStructure s = chain(2, 1.0, 400.0);
  const Eigen::MatrixXd y = decay(s, 300, 0.01, 1);
  EXPECT_THROW(identify_decays({}, {.sample_rate_hz = 20.0}), std::invalid_argument);
  EXPECT_THROW(identify_decays({y, y.topRows(1)}, {.sample_rate_hz = 20.0}), std::invalid_argument);
  EXPECT_THROW(identify_decays({y.leftCols(5)}, {.sample_rate_hz = 20.0}), std::invalid_argument);
  EXPECT_THROW(identify_decays({0.0 * y}, {.sample_rate_hz = 20.0}), std::invalid_argument);
  EXPECT_THROW(identify_decays({y}, {.sample_rate_hz = 20.0, .lowest_hz = 5.0, .highest_hz = 4.0}),
               std::invalid_argument);
  Eigen::MatrixXd broken = y;
  broken(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(identify_decays({broken}, {.sample_rate_hz = 20.0}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals
