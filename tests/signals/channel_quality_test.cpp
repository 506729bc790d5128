#include "signals/channel_quality.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace wheeltap::signals {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<double> noise(std::size_t samples, double step = 0.0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x;
  for (std::size_t i = 0; i < samples; ++i) {
    const double value = normal(random);
    x.push_back(step > 0.0 ? step * std::round(value / step) : value);
  }
  return x;
}

std::vector<double> sine(std::size_t samples, double per_sample) {
  std::vector<double> x;
  for (std::size_t i = 0; i < samples; ++i)
    x.push_back(std::sin(2.0 * std::numbers::pi * per_sample * static_cast<double>(i)));
  return x;
}

// Good channels have no remarks, however coarse their resolution.
TEST(ChannelQuality, FindsNoFaultsInGoodChannels) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const auto& x : {noise(20000, 0.0, seed), noise(20000, 0.3, seed), sine(20000, 0.0137)}) {
      const ChannelQuality q = channel_quality(x);
      EXPECT_THAT(q.dropouts, IsEmpty());
      EXPECT_THAT(q.spikes, IsEmpty());
      EXPECT_EQ(q.clipped_high + q.clipped_low, 0);
      EXPECT_LT(std::abs(q.drift), 0.3);
      EXPECT_LT(q.wander, 0.1);
      EXPECT_EQ(q.missing, 0);
    }
}

TEST(ChannelQuality, ComputesMoments) {
  std::vector<double> x = {1.0, 2.0, 3.0, std::numeric_limits<double>::quiet_NaN(), 6.0};
  const ChannelQuality q = channel_quality(x);
  EXPECT_EQ(q.samples, 5);
  EXPECT_EQ(q.missing, 1);
  EXPECT_DOUBLE_EQ(q.mean, 3.0);
  EXPECT_DOUBLE_EQ(q.rms, std::sqrt(50.0 / 4.0));
  EXPECT_DOUBLE_EQ(q.sd, std::sqrt(14.0 / 4.0));
  EXPECT_EQ(q.step, 1.0);
  EXPECT_TRUE(channel_quality(std::vector<double>(10, 2.0)).constant);
  EXPECT_EQ(channel_quality(std::vector<double>()).samples, 0);
}

TEST(ChannelQuality, FindsDropouts) {
  for (const double step : {0.0, 0.1}) {
    auto x = noise(20000, step);
    for (std::size_t i = 5000; i < 5040; ++i) x[i] = x[5000];
    const ChannelQuality q = channel_quality(x);
    ASSERT_THAT(q.dropouts, SizeIs(1)) << step;
    EXPECT_NEAR(static_cast<double>(q.dropouts[0].begin), 5000, 1);
    EXPECT_NEAR(static_cast<double>(q.dropouts[0].end), 5040, 1);
  }
}

TEST(ChannelQuality, FindsClipping) {
  auto x = sine(20000, 0.0137);
  for (double& value : x) value = std::min(value, 0.9);
  const ChannelQuality q = channel_quality(x);
  // The sine is above 0.9 for acos(0.9)/π of the time.
  EXPECT_NEAR(static_cast<double>(q.clipped_high), 20000 * std::acos(0.9) / std::numbers::pi, 100);
  EXPECT_EQ(q.clipped_low, 0);
  EXPECT_THAT(q.dropouts, IsEmpty());
}

TEST(ChannelQuality, FindsSpikes) {
  auto x = sine(20000, 0.0137);
  const auto small = noise(20000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.01 * small[i];
  x[7000] += 3.0;
  x[13000] -= 2.0;
  EXPECT_THAT(channel_quality(x).spikes, ElementsAre(7000, 13000));
}

TEST(ChannelQuality, FindsTrendAndDrift) {
  auto x = noise(20000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += 5.0 * static_cast<double>(i) / 20000.0;
  EXPECT_NEAR(channel_quality(x).drift, 5.0, 0.2);
  EXPECT_LT(channel_quality(x).wander, 0.1);
  auto y = noise(20000);
  const auto slow = sine(20000, 2.0 / 20000.0);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += 3.0 * slow[i];
  EXPECT_GT(channel_quality(y).wander, 0.8);
}

TEST(ChannelQuality, FaultsCarryValueAndBound) {
  auto x = noise(20000);
  EXPECT_THAT(channel_faults(channel_quality(x), true), IsEmpty());
  x[7] = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += 5.0 * static_cast<double>(i) / 20000.0;
  const auto found = channel_faults(channel_quality(x), true);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].fault, ChannelFault::missing);
  EXPECT_EQ(found[0].value, 1.0);
  EXPECT_EQ(found[1].fault, ChannelFault::drift);
  EXPECT_NEAR(found[1].value, 5.0, 0.2);
  EXPECT_EQ(found[1].bound, 1.0);
  EXPECT_THAT(channel_faults(channel_quality(x), false), SizeIs(1));
}

TEST(SpectrumPeaks, AreFoundByTheirProminence) {
  auto x = noise(60000);
  const auto a = sine(60000, 0.05), b = sine(60000, 0.1234);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += 2.0 * a[i] + b[i];
  const auto peaks = spectrum_peaks(welch(x, 100.0, {.segment = 2048}), 5);
  ASSERT_THAT(peaks, SizeIs(2));
  EXPECT_NEAR(peaks[0].frequency_hz, 5.0, 0.02);
  EXPECT_NEAR(peaks[1].frequency_hz, 12.34, 0.02);
  EXPECT_THAT(spectrum_peaks(welch(noise(60000), 100.0, {.segment = 2048}), 5), IsEmpty());
  EXPECT_THAT(spectrum_peaks(welch(x, 100.0, {.segment = 2048}), 1), SizeIs(1));
}

}  // namespace
}  // namespace wheeltap::signals
