#include "signals/channel_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wheeltap::signals {
namespace {

constexpr long kShortestDropout = 5;
constexpr double kExpectedRuns = 1e-3;
constexpr long kClippedRun = 3;
constexpr double kSpike = 12.0;  // robust standard deviations
constexpr double kMadToSd = 1.4826;
constexpr std::size_t kBlock = 500;   // samples
constexpr double kMostSpikes = 1e-3;  // share of all samples
constexpr int kDriftBlocks = 20;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<Stretch> equal_runs(std::span<const double> x) {
  std::vector<Stretch> out;
  const auto n = static_cast<long>(x.size());
  for (long i = 0; i < n;) {
    long end = i + 1;
    while (end < n && x[static_cast<std::size_t>(end)] == x[static_cast<std::size_t>(i)]) ++end;
    if (end - i > 1) out.push_back({i, end});
    i = end;
  }
  return out;
}

// Estimates p, the share of equal neighbouring samples, without the longest runs. These runs may be
// dropouts.
long shortest_dropout(const std::vector<Stretch>& runs, long samples) {
  constexpr long kLong = 10;
  long equal = 0, counted = samples - 1;
  for (const Stretch& run : runs) {
    const long pairs = run.end - run.begin - 1;
    (run.end - run.begin > kLong ? counted : equal) += run.end - run.begin > kLong ? -pairs : pairs;
  }
  const double p = counted > 0 ? static_cast<double>(equal) / static_cast<double>(counted) : 0.0;
  if (!(p > 0.0)) return kShortestDropout;
  if (p >= 0.99) return std::max(kShortestDropout, samples / 10);
  // n p^(L - 1) = expected
  const double length = 1.0 + std::log(kExpectedRuns / static_cast<double>(samples)) / std::log(p);
  return std::max(kShortestDropout, static_cast<long>(std::ceil(length)));
}

void find_runs(std::span<const double> x, ChannelQuality& out) {
  const std::vector<Stretch> runs = equal_runs(x);
  const long shortest = shortest_dropout(runs, out.samples);
  bool high = false, low = false;
  for (const Stretch& run : runs) {
    const double value = x[static_cast<std::size_t>(run.begin)];
    const long length = run.end - run.begin;
    const bool at_end = value == out.highest || value == out.lowest;
    if (at_end && length >= kClippedRun) (value == out.highest ? high : low) = true;
    if (!at_end && length >= shortest) out.dropouts.push_back(run);
  }
  if (high) out.clipped_high = std::ranges::count(x, out.highest);
  if (low) out.clipped_low = std::ranges::count(x, out.lowest);
}

void find_spikes(std::span<const double> x, ChannelQuality& out) {
  const auto n = static_cast<long>(x.size());
  if (n < 5) return;
  std::vector<double> off(x.size(), 0.0), sizes;
  const auto at = [&](long i) { return x[static_cast<std::size_t>(i)]; };
  // x_i minus the cubic through x_{i-2}, x_{i-1}, x_{i+1}, x_{i+2}: (-1, 4, 4, -1) / 6.
  const auto difference = [](double a, double b, double c, double d, double e) {
    return c - (4.0 * (b + d) - (a + e)) / 6.0;
  };
  for (long i = 2; i + 2 < n; ++i) {
    off[static_cast<std::size_t>(i)] =
        difference(at(i - 2), at(i - 1), at(i), at(i + 1), at(i + 2));
    sizes.push_back(std::abs(off[static_cast<std::size_t>(i)]));
  }
  // After replacement of x_i, the differences of the neighbouring samples must be below the limit.
  // A pulse of two or more samples is not a spike.
  const auto is_single = [&](long i, double jump) {
    constexpr double kWeights[] = {-1.0 / 6.0, 4.0 / 6.0};
    for (const long k : {-2L, -1L, 1L, 2L}) {
      if (i + k < 2 || i + k + 2 >= n) continue;
      const double rest =
          off[static_cast<std::size_t>(i + k)] + kWeights[std::abs(k) == 1 ? 1 : 0] * jump;
      if (std::abs(rest) > 0.3 * std::abs(jump)) return false;
    }
    return true;
  };
  // The scale is the largest of the scales of three blocks around a sample, so that a burst is not
  // a spike. If most differences of a coarse record are 0, only nonzero differences count.
  const auto scale_of = [&](std::size_t from, std::size_t to) {
    std::vector<double> part(sizes.begin() + static_cast<std::ptrdiff_t>(from),
                             sizes.begin() + static_cast<std::ptrdiff_t>(to));
    if (const double all = median_of(part); all > 0.0) return kMadToSd * all;
    std::erase(part, 0.0);
    return kMadToSd * median_of(std::move(part));
  };
  std::vector<double> scales;
  for (std::size_t from = 0; from < sizes.size(); from += kBlock)
    scales.push_back(scale_of(from, std::min(from + kBlock, sizes.size())));
  for (long i = 2; i + 2 < n; ++i) {
    const auto block = static_cast<std::size_t>(i - 2) / kBlock;
    double scale = scales[block];
    if (block > 0) scale = std::max(scale, scales[block - 1]);
    if (block + 1 < scales.size()) scale = std::max(scale, scales[block + 1]);
    const double jump = off[static_cast<std::size_t>(i)];
    if (scale > 0.0 && std::abs(jump) > kSpike * scale && std::abs(jump) > kSpike * out.step &&
        std::abs(at(i + 1) - at(i - 1)) < 0.5 * std::abs(jump) && is_single(i, jump))
      out.spikes.push_back(i);
  }
  // If outliers are frequent, they belong to the signal.
  if (static_cast<double>(out.spikes.size()) > kMostSpikes * static_cast<double>(n))
    out.spikes.clear();
}

void find_drift(std::span<const double> x, ChannelQuality& out) {
  const auto n = static_cast<long>(x.size());
  if (n < 2 * kDriftBlocks) return;
  std::vector<double> rest(x.begin(), x.end());
  const auto count = static_cast<double>(n);
  double slope = 0.0, weight = 0.0;
  for (long i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) - 0.5 * (count - 1.0);
    slope += t * (x[static_cast<std::size_t>(i)] - out.mean);
    weight += t * t;
  }
  slope /= weight;
  detrend(rest, 1);
  double square = 0.0;
  for (const double r : rest) square += r * r;
  const double sd = std::sqrt(square / count);
  if (!(sd > 1e-12 * out.sd)) {
    out.drift = std::copysign(std::numeric_limits<double>::infinity(), slope);
    return;
  }
  out.drift = slope * count / sd;
  double blocks = 0.0;
  for (int b = 0; b < kDriftBlocks; ++b) {
    const long from = n * b / kDriftBlocks, to = n * (b + 1) / kDriftBlocks;
    double sum = 0.0;
    for (long i = from; i < to; ++i) sum += rest[static_cast<std::size_t>(i)];
    const double mean = sum / static_cast<double>(to - from);
    blocks += mean * mean / kDriftBlocks;
  }
  out.wander = std::sqrt(blocks) / sd;
}

}  // namespace

ChannelQuality channel_quality(std::span<const double> all) {
  std::vector<double> x;
  x.reserve(all.size());
  for (const double value : all)
    if (std::isfinite(value)) x.push_back(value);
  ChannelQuality out{.samples = static_cast<long>(all.size()),
                     .missing = static_cast<long>(all.size() - x.size())};
  if (x.empty()) return out;
  const auto n = static_cast<double>(x.size());
  for (const double value : x) out.mean += value / n;
  double square = 0.0, variance = 0.0;
  for (const double value : x) {
    square += value * value;
    variance += (value - out.mean) * (value - out.mean);
  }
  out.rms = std::sqrt(square / n);
  out.sd = std::sqrt(variance / n);
  const auto [low, high] = std::ranges::minmax(x);
  out.lowest = low;
  out.highest = high;
  out.constant = low == high;
  if (out.constant) return out;
  std::vector<double> sorted = x;
  std::ranges::sort(sorted);
  out.step = high - low;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (const double gap = sorted[i] - sorted[i - 1]; gap > 1e-12 * (high - low))
      out.step = std::min(out.step, gap);
  find_runs(x, out);
  find_spikes(x, out);
  find_drift(x, out);
  return out;
}

std::vector<FoundFault> channel_faults(const ChannelQuality& q, bool is_record) {
  using enum ChannelFault;
  std::vector<FoundFault> out;
  if (q.missing > 0) out.push_back({missing, static_cast<double>(q.missing)});
  if (q.missing == q.samples || !is_record) return out;
  if (q.constant) {
    out.push_back({constant, q.mean});
    return out;
  }
  if (std::isinf(q.drift)) return {{counter, q.drift}};
  const auto judge = [&](ChannelFault fault, double value, double bound) {
    if (value > bound) out.push_back({fault, value, bound});
  };
  long still = 0;
  for (const Stretch& d : q.dropouts) still += d.end - d.begin;
  judge(dropouts, static_cast<double>(still), 0.0);
  judge(clipped, static_cast<double>(q.clipped_high + q.clipped_low), 0.0);
  judge(spikes, static_cast<double>(q.spikes.size()), 0.0);
  if (std::abs(q.drift) > 1.0)
    out.push_back({drift, q.drift, 1.0});
  else
    judge(wander, q.wander, 0.3);
  // The comparison avoids a division, because the standard deviation may be 0.
  if (std::abs(q.mean) > 3.0 * q.sd) out.push_back({offset, std::abs(q.mean) / q.sd, 3.0});
  if (q.step > 0.05 * q.sd) out.push_back({coarse, q.step / q.sd, 0.05});
  return out;
}

std::vector<SpectrumPeak> spectrum_peaks(const Spectrum& spectrum, int most, double least_db) {
  std::vector<SpectrumPeak> peaks;
  const auto n = static_cast<long>(spectrum.density.size());
  std::vector<double> level;  // dB
  double floor = std::numeric_limits<double>::infinity();
  for (const double d : spectrum.density)
    if (d > 0.0) floor = std::min(floor, 10.0 * std::log10(d));
  for (const double d : spectrum.density) level.push_back(d > 0.0 ? 10.0 * std::log10(d) : floor);
  const auto at = [&](long i) { return level[static_cast<std::size_t>(i)]; };
  for (long i = 1; i + 1 < n; ++i) {
    if (!(at(i) > at(i - 1) && at(i) >= at(i + 1))) continue;
    double left = at(i), right = at(i);
    for (long k = i - 1; k >= 0 && at(k) <= at(i); --k) left = std::min(left, at(k));
    for (long k = i + 1; k < n && at(k) <= at(i); ++k) right = std::min(right, at(k));
    const double prominence = at(i) - std::max(left, right);
    if (prominence < least_db) continue;
    const double curvature = at(i - 1) - 2.0 * at(i) + at(i + 1);
    const double shift = curvature < 0.0 ? 0.5 * (at(i - 1) - at(i + 1)) / curvature : 0.0;
    const double line = spectrum.frequencies_hz[1] - spectrum.frequencies_hz[0];
    peaks.push_back({spectrum.frequencies_hz[static_cast<std::size_t>(i)] + shift * line,
                     spectrum.density[static_cast<std::size_t>(i)], prominence});
  }
  std::ranges::sort(peaks, std::ranges::greater{}, &SpectrumPeak::prominence_db);
  if (static_cast<int>(peaks.size()) > most) peaks.resize(static_cast<std::size_t>(most));
  std::ranges::sort(peaks, {}, &SpectrumPeak::frequency_hz);
  return peaks;
}

}  // namespace wheeltap::signals
