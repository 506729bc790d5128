#include "signals/modal/frequency_domain_decomposition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>

#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

VibratingStructure three() {
  return chain(3, 1.0, 200.0);
}

TEST(FrequencyDomainDecomposition, FindsModesWithinTheLineSpacing) {
  const VibratingStructure s = three();
  const VibratingStructure::Modes truth = s.modes();
  const ModalResult found = decompose_spectra(s.accelerations(18000, 0.05, 1),
                                              {.sample_rate_hz = 20.0, .enhanced = false});
  ASSERT_EQ(found.modes.size(), 3U);
  EXPECT_EQ(found.covariance.size(), 0);
  for (Index m = 0; m < 3; ++m) {
    const Mode& mode = found.modes[static_cast<std::size_t>(m)];
    // Half a line, and the scatter of a resonance with 1.5 % damping.
    EXPECT_NEAR(mode.pole.frequency_hz, truth.frequencies_hz[m],
                found.sample_rate_hz / found.segment + 0.01 * truth.frequencies_hz[m]);
    EXPECT_TRUE(std::isnan(mode.pole.damping) && std::isnan(mode.pole.frequency_sd));
    EXPECT_GT(modal_assurance(mode.pole.shape, truth.shapes.col(m).cast<std::complex<double>>()),
              0.99);
    EXPECT_TRUE(mode.doubts.empty());
  }
}

// For 100 records: squared errors over predicted variances have the mean 1 + bias²/variance + the
// effect of 20 blocks (19/17). The mean over 300 has a standard error of about 0.1.
TEST(FrequencyDomainDecomposition, CovarianceMatchesTheScatterBetweenRecords) {
  const VibratingStructure s = three();
  const VibratingStructure::Modes truth = s.modes();
  double frequency = 0.0, damping = 0.0, bias = 0.0;
  int modes = 0, inside_frequency = 0, inside_damping = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const ModalResult found =
        decompose_spectra(s.accelerations(18000, 0.05, seed), {.sample_rate_hz = 20.0});
    ASSERT_EQ(found.modes.size(), 3U) << seed;
    for (Index m = 0; m < 3; ++m) {
      const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
      const double f = (p.frequency_hz - truth.frequencies_hz[m]) / p.frequency_sd;
      const double z = (p.damping - s.damping_ratio) / p.damping_sd;
      frequency += f * f;
      damping += z * z;
      bias += p.damping / s.damping_ratio - 1.0;
      inside_frequency += std::abs(f) < 1.96 ? 1 : 0;
      inside_damping += std::abs(z) < 1.96 ? 1 : 0;
      ++modes;
    }
  }
  std::printf("f: %.2f, %.1f %% inside; damping: %.2f, %.1f %% inside, bias %.1f %%\n",
              frequency / modes, 100.0 * inside_frequency / modes, damping / modes,
              100.0 * inside_damping / modes, 100.0 * bias / modes);
  EXPECT_NEAR(frequency / modes, 1.2, 0.5);
  EXPECT_LT(damping / modes, 2.5);
  EXPECT_LT(std::abs(bias / modes), 0.1);
}

// A motor's tone has no damping and a constant amplitude; white noise has no peak.
TEST(FrequencyDomainDecomposition, DoubtsTonesAndFindsNoModesInNoise) {
  const VibratingStructure s = three();
  MatrixXd y = s.accelerations(18000, 0.05, 1);
  const double size = 2.0 * std::sqrt(y.row(0).squaredNorm() / 18000.0);
  for (Index k = 0; k < y.cols(); ++k)
    for (Index c = 0; c < y.rows(); ++c)
      y(c, k) += size * (1.0 + 0.3 * static_cast<double>(c)) *
                 std::sin(2.0 * 3.14159265358979 * 6.1 * 0.05 * static_cast<double>(k));
  const ModalResult found = decompose_spectra(y, {.sample_rate_hz = 20.0, .enhanced = false});
  bool doubted = false;
  for (const Mode& mode : found.modes)
    if (std::abs(mode.pole.frequency_hz - 6.1) < 0.1)
      doubted = std::ranges::find(mode.doubts, ModeDoubt::tone) != mode.doubts.end();
  EXPECT_TRUE(doubted);
  base::Random random(1, 0, 0, base::Purpose::test);
  for (double& x : y.reshaped()) x = random.normal();
  EXPECT_TRUE(decompose_spectra(y, {.sample_rate_hz = 20.0}).modes.empty());
}

TEST(FrequencyDomainDecomposition, RejectsTooFewSegments) {
  const MatrixXd y = three().accelerations(400, 0.05, 1);
  EXPECT_THROW((void)decompose_spectra(y, {.sample_rate_hz = 20.0, .segment = 128}),
               std::invalid_argument);
  EXPECT_THROW(
      (void)decompose_spectra(y, {.sample_rate_hz = 20.0, .lowest_hz = 5.0, .highest_hz = 5.1}),
      std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals
