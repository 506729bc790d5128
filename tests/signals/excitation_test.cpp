#include "signals/excitation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "signals/spectra.hpp"

namespace {

using namespace wheeltap::signals;

TEST(Noise, IsReproducibleAcrossComputers) {
  // The standard defines the ten-thousandth output of a default mt19937_64; ours are its top 53
  // bits.
  Noise noise(5489);
  double last = 0.0;
  for (int i = 0; i < 10000; ++i) last = noise.uniform();
  EXPECT_EQ(last, (static_cast<double>(9981545732273789042ULL >> 11) + 0.5) * 0x1.0p-53);
}

// Mean, variance and fourth moment of N normals, each within five standard errors.
TEST(WhiteNoise, HasItsMoments) {
  Noise noise(1);
  const int n = 100000;
  double m1 = 0.0, m2 = 0.0, m4 = 0.0;
  for (double x : white_noise(n, 4.0, noise)) {
    const double z = x / 2.0;
    m1 += z / n;
    m2 += z * z / n;
    m4 += z * z * z * z / n;
  }
  EXPECT_NEAR(m1, 0.0, 5.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(m2, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(m4, 3.0, 5.0 * std::sqrt(96.0 / n));
  EXPECT_THROW((void)white_noise(10, -1.0, noise), std::invalid_argument);
}

TEST(BandLimitedNoise, StaysInItsBand) {
  Noise noise(2);
  double power = 0.0;
  for (int run = 0; run < 20; ++run) {
    const std::vector<double> x = band_limited_noise(8192, 1000.0, 50.0, 150.0, 9.0, noise);
    ASSERT_EQ(x.size(), 8192U);
    const Spectrum s = welch(x, 1000.0, {.segment = 1024});
    double in = 0.0, out = 0.0;
    for (std::size_t i = 0; i < s.density.size(); ++i)
      (s.frequencies_hz[i] > 47.0 && s.frequencies_hz[i] < 153.0 ? in : out) += s.density[i];
    EXPECT_LT(out, 1e-3 * in);
    for (double value : x) power += value * value / (20.0 * 8192.0);
  }
  // 20 records of T = 8.192 s in a band B = 100 Hz: relative standard error 1/√(20 B T).
  EXPECT_NEAR(power, 9.0, 5.0 * 9.0 / std::sqrt(20.0 * 100.0 * 8.192));
  EXPECT_THROW((void)band_limited_noise(100, 10.0, 4.0, 6.0, 1.0, noise), std::invalid_argument);
  EXPECT_THROW((void)band_limited_noise(16, 10.0, 4.001, 4.002, 1.0, noise), std::invalid_argument);
}

TEST(Multisine, HasTheRequestedLinesAndLevel) {
  Noise noise(3);
  const Multisine options{
      .period = 512, .low_hz = 5.0, .high_hz = 20.0, .rms = 2.5, .odd_lines_only = true};
  const std::vector<double> x = multisine(1024, 100.0, options, noise);
  double sum = 0.0;
  for (double value : x) sum += value * value / 1024.0;
  EXPECT_NEAR(std::sqrt(sum), 2.5, 1e-12);
  for (std::size_t n = 0; n < 512; ++n) EXPECT_EQ(x[n], x[n + 512]);
  // Hann leaks a line into its neighbours, so even lines appear only two away from the band.
  const Spectrum s = welch(x, 100.0, {.segment = 1024, .overlap = 0.0});
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    const double f = s.frequencies_hz[i];
    const std::size_t line = i / 2;
    const bool excited = i % 2 == 0 && line % 2 == 1 && f >= 5.0 && f <= 20.0;
    if (excited) {
      EXPECT_GT(s.density[i], 0.01);
    }
    if (i % 4 == 0 || f < 4.5 || f > 20.5) {
      EXPECT_LT(s.density[i], 1e-20) << f;
    }
  }
  EXPECT_THROW((void)multisine(10, 100.0, {.period = 8, .low_hz = 1.0, .high_hz = 2.0}, noise),
               std::invalid_argument);
  EXPECT_THROW((void)multisine(10, 100.0, {.low_hz = 1.0, .high_hz = 60.0}, noise),
               std::invalid_argument);
}

TEST(Sine, IsASine) {
  const std::vector<double> x = sine(100, 50.0, 2.0, 5.0, 0.1);
  EXPECT_NEAR(x[7], 2.0 * std::sin(2.0 * 3.141592653589793 * 0.7 + 0.1), 1e-12);
  EXPECT_THROW((void)sine(0, 50.0, 1.0, 1.0), std::invalid_argument);
}

}  // namespace
