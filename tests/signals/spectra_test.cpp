#include "signals/spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "base/constants.hpp"
#include "signals/excitation.hpp"

namespace {

using namespace wheeltap::signals;

double integral(const Spectrum& s) {
  double sum = 0.0;
  for (double d : s.density) sum += d;
  return sum * (s.frequencies_hz[1] - s.frequencies_hz[0]);
}

// White noise of variance 4 at 100 Hz has the density 2 · 4 / 100. The relative scatter of the
// estimate is √(19 / (18 K)) per line, and that of its integral √(2 / N) of the variance.
TEST(Welch, WhiteNoiseIsFlat) {
  Noise noise(1);
  const std::vector<double> x = white_noise(200000, 4.0, noise);
  for (int segment : {256, 255}) {
    const Spectrum s = welch(x, 100.0, {.segment = segment});
    EXPECT_NEAR(integral(s), 4.0, 5.0 * 4.0 * std::sqrt(2.0 / 200000) + 0.03);
    double squares = 0.0;
    int lines = 0;
    for (std::size_t i = 2; i + 2 < s.density.size(); ++i, ++lines) {
      const double z = (s.density[i] / 0.08 - 1.0) / std::sqrt(19.0 / (18.0 * s.segments));
      EXPECT_LT(std::abs(z), 5.0);
      squares += z * z;
    }
    EXPECT_NEAR(squares / lines, 1.0, 0.5);  // neighbouring lines are correlated
  }
}

// Parseval for one component: the variance of a sine, wherever it lies between the lines.
TEST(Welch, SineHasItsPower) {
  for (double f : {12.5, 13.1}) {
    const std::vector<double> x = sine(4096, 100.0, 3.0, f, 0.3);
    const Spectrum s = welch(x, 100.0, {.segment = 512});
    EXPECT_NEAR(integral(s), 4.5, 5e-3);
    const auto peak = std::max_element(s.density.begin(), s.density.end()) - s.density.begin();
    EXPECT_NEAR(s.frequencies_hz[static_cast<std::size_t>(peak)], f, 0.5 * 100.0 / 512);
  }
  EXPECT_THROW((void)welch(std::vector<double>(3), 1.0), std::invalid_argument);
  EXPECT_THROW((void)welch(std::vector<double>(8), 0.0), std::invalid_argument);
  EXPECT_THROW((void)welch(std::vector<double>(8), 1.0, {.overlap = 1.0}), std::invalid_argument);
}

// y_n = x_n + 0.5 x_{n-1}: H = 1 + 0.5 e^{-iω}. Noise on the output biases H2 alone, by 1/γ².
TEST(FrequencyResponse, FindsAKnownFilter) {
  Noise noise(2);
  const std::vector<double> x = white_noise(100000, 1.0, noise);
  std::vector<double> clean(x), noisy(x);
  for (std::size_t n = 1; n < x.size(); ++n) clean[n] = x[n] + 0.5 * x[n - 1];
  for (std::size_t n = 0; n < x.size(); ++n) noisy[n] = clean[n] + 0.7 * noise.normal();
  const FrequencyResponse exact = frequency_response(x, clean, 1.0, {.segment = 512});
  const FrequencyResponse rough = frequency_response(x, noisy, 1.0, {.segment = 512});
  for (std::size_t i = 2; i + 2 < exact.h1.size(); ++i) {
    const std::complex<double> h =
        1.0 + 0.5 * std::polar(1.0, -2.0 * wheeltap::kPi * exact.frequencies_hz[i]);
    EXPECT_LT(std::abs(exact.h1[i] - h), 0.01);
    EXPECT_LT(std::abs(exact.h2[i] - h), 0.01);
    EXPECT_GT(exact.coherence[i], 0.999);
    const double gamma2 = std::norm(h) / (std::norm(h) + 0.49);
    const double scatter = std::sqrt((1.0 - gamma2) / gamma2 / (2.0 * rough.segments));
    EXPECT_LT(std::abs(rough.h1[i] - h), 6.0 * scatter * std::abs(h) * std::sqrt(2.0));
    EXPECT_NEAR(std::abs(rough.h1[i] / rough.h2[i]), rough.coherence[i], 1e-12);
    EXPECT_NEAR(rough.coherence[i], gamma2, 0.25);
  }
}

TEST(CompareWindow, DetectsAnUnrepresentativeWindow) {
  Noise noise(3);
  std::vector<double> x = white_noise(20000, 1.0, noise);
  const SpectrumComparison alike = compare_window(x, 4000, 9000, 100.0, {.segment = 256});
  EXPECT_NEAR(alike.power_ratio, 1.0, 5.0 * std::sqrt(2.0 / 5000));
  EXPECT_LT(alike.difference_db, 1.5 * alike.expected_db);
  for (std::size_t n = 4000; n < 9000; ++n) x[n] *= 0.3;
  const SpectrumComparison unlike = compare_window(x, 4000, 9000, 100.0, {.segment = 256});
  EXPECT_LT(unlike.power_ratio, 0.2);
  EXPECT_GT(unlike.difference_db, 5.0 * unlike.expected_db);
  EXPECT_THROW((void)compare_window(x, 5, 5, 100.0), std::invalid_argument);
  EXPECT_THROW((void)compare_window(x, 0, 20001, 100.0), std::invalid_argument);
}

// At 610 Hz linear interpolation keeps 0.96 at 68 Hz and 0.69 at 200 Hz.
TEST(LinearInterpolationLoss, IsSincSquared) {
  for (const auto& [f, kept] : {std::pair{68.0, 0.96}, {200.0, 0.69}}) {
    const Spectrum s = welch(sine(16384, 610.35, 1.0, f), 610.35);
    EXPECT_NEAR(1.0 - linear_interpolation_loss(s, 610.35), kept, 6e-3);
  }
}

TEST(Detrend, RemovesALine) {
  std::vector<double> x;
  for (int n = 0; n < 50; ++n) x.push_back(3.0 - 0.2 * n);
  std::vector<double> y = x;
  detrend(x, 1);
  for (double value : x) EXPECT_NEAR(value, 0.0, 1e-13);
  detrend(y, 0);
  EXPECT_NEAR(y[0], 0.2 * 24.5, 1e-13);
  EXPECT_THROW(detrend(y, 2), std::invalid_argument);
}

TEST(Upsample, IsAccurateInsideAndKeepsTheSamples) {
  // Components up to 0.43 of the sampling rate.
  const auto f = [](double t) {
    return 0.2 + std::sin(2.0 * wheeltap::kPi * 0.43 * t) +
           std::cos(2.0 * wheeltap::kPi * 0.3331 * t + 1.0) +
           std::sin(2.0 * wheeltap::kPi * 0.01 * t);
  };
  std::vector<double> x;
  for (int i = 0; i < 400; ++i) x.push_back(f(i));
  const int factor = 4;
  // A window inside the record uses the samples around it; the whole record has ends.
  for (const auto& [begin, end, skip] : {std::tuple{100, 200, 0}, {0, 400, 32}}) {
    const std::vector<double> y = upsample(x, begin, end, factor);
    ASSERT_EQ(y.size(), static_cast<std::size_t>((end - begin - 1) * factor + 1));
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double t = begin + static_cast<double>(i) / factor;
      if (i % factor == 0) {
        EXPECT_EQ(y[i], x[static_cast<std::size_t>(t)]);
      }
      if (t >= begin + skip && t <= end - 1 - skip) {
        EXPECT_NEAR(y[i], f(t), 2.2e-5) << t;
      }
      EXPECT_NEAR(y[i], f(t), 2.0);
    }
  }
  const std::vector<double> constant = upsample(std::vector<double>(5, 2.5), 0, 5, 3);
  for (double value : constant) EXPECT_NEAR(value, 2.5, 1e-14);
  EXPECT_THROW((void)upsample(x, 0, 401, 2), std::invalid_argument);
  EXPECT_THROW((void)upsample(x, 0, 400, 0), std::invalid_argument);
}

TEST(Decimate, KeepsBelowAndRemovesAbove) {
  const int factor = 5;
  std::vector<double> low, high;
  for (int i = 0; i < 4000; ++i) {
    low.push_back(std::sin(2.0 * wheeltap::kPi * 0.4 / factor * i));
    high.push_back(std::sin(2.0 * wheeltap::kPi * 0.5 / factor * 1.001 * i) +
                   std::cos(2.0 * wheeltap::kPi * 0.37 * i));
  }
  const std::vector<double> kept = decimate(low, factor), removed = decimate(high, factor);
  ASSERT_EQ(kept.size(), 800U);
  for (std::size_t n = 32; n + 32 < kept.size(); ++n) {
    EXPECT_NEAR(kept[n], low[n * factor], 1e-4);
    EXPECT_NEAR(removed[n], 0.0, 2e-4);
  }
  EXPECT_EQ(decimate(low, 1), low);
  EXPECT_THROW((void)decimate(low, 0), std::invalid_argument);
}

}  // namespace
