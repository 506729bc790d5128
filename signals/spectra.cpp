#include "signals/spectra.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

#include "base/constants.hpp"

namespace wheeltap::signals {

namespace {

using Complex = std::complex<double>;

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x);
}

double variance(std::span<const double> x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  double sum = 0.0;
  for (double value : x) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(x.size());
}

/// Averaged one-sided auto- and cross-spectra of x and y (x = y for a PSD).
struct CrossSpectra {
  std::vector<double> frequencies_hz, xx, yy;
  std::vector<Complex> xy;
  int segments = 0;
};

CrossSpectra cross_spectra(std::span<const double> x, std::span<const double> y, double rate,
                           const WelchOptions& options) {
  const auto fail = [](const std::string& what) { throw std::invalid_argument("welch: " + what); };
  if (x.size() != y.size())
    fail(std::to_string(x.size()) + " and " + std::to_string(y.size()) + " samples, must be equal");
  if (x.size() < 4) fail(std::to_string(x.size()) + " samples, must be at least 4");
  if (!(rate > 0.0)) fail("sample rate = " + std::to_string(rate) + " Hz, must be > 0");
  if (options.segment < 4) fail("segment = " + std::to_string(options.segment) + ", must be >= 4");
  if (!(options.overlap >= 0.0 && options.overlap < 1.0))
    fail("overlap = " + std::to_string(options.overlap) + ", must be in [0, 1)");

  const std::size_t length = std::min(x.size(), static_cast<std::size_t>(options.segment));
  const auto hop = std::max<std::size_t>(
      1,
      static_cast<std::size_t>(std::lround(static_cast<double>(length) * (1.0 - options.overlap))));
  std::vector<double> hann(length);
  double power = 0.0;
  for (std::size_t n = 0; n < length; ++n) {
    hann[n] =
        0.5 - 0.5 * std::cos(2.0 * kPi * static_cast<double>(n) / static_cast<double>(length));
    power += hann[n] * hann[n];
  }
  const std::size_t lines = length / 2 + 1;
  CrossSpectra s{.frequencies_hz = {},
                 .xx = std::vector<double>(lines, 0.0),
                 .yy = std::vector<double>(lines, 0.0),
                 .xy = std::vector<Complex>(lines, 0.0)};
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> piece(length);
  std::vector<Complex> fx, fy;
  const bool same = x.data() == y.data();
  const auto transform = [&](std::span<const double> signal, std::size_t begin,
                             std::vector<Complex>& out) {
    const auto segment = signal.subspan(begin, length);
    const double mean =
        std::accumulate(segment.begin(), segment.end(), 0.0) / static_cast<double>(length);
    for (std::size_t n = 0; n < length; ++n) piece[n] = hann[n] * (segment[n] - mean);
    fft.fwd(out, piece);
  };
  for (std::size_t begin = 0; begin + length <= x.size(); begin += hop) {
    transform(x, begin, fx);
    if (!same) transform(y, begin, fy);
    const std::vector<Complex>& other = same ? fx : fy;
    for (std::size_t i = 0; i < lines; ++i) {
      s.xx[i] += std::norm(fx[i]);
      s.yy[i] += std::norm(other[i]);
      s.xy[i] += std::conj(fx[i]) * other[i];
    }
    ++s.segments;
  }
  for (std::size_t i = 0; i < lines; ++i) {
    const bool alone = i == 0 || (length % 2 == 0 && i + 1 == lines);  // line without a counterpart
                                                                       // at negative frequency
    const double scale = (alone ? 1.0 : 2.0) / (rate * power * s.segments);
    s.xx[i] *= scale;
    s.yy[i] *= scale;
    s.xy[i] *= scale;
    s.frequencies_hz.push_back(static_cast<double>(i) * rate / static_cast<double>(length));
  }
  return s;
}

/// Computes Kaiser's window at t in [-1, 1].
double kaiser(double t, double beta) {
  return boost::math::cyl_bessel_i(0, beta * std::sqrt(std::max(0.0, 1.0 - t * t))) /
         boost::math::cyl_bessel_i(0, beta);
}

/// Returns sample n of a record that is continued by odd reflection at its ends.
double reflected(std::span<const double> x, std::ptrdiff_t n) {
  const auto last = static_cast<std::ptrdiff_t>(x.size()) - 1;
  double sign = 1.0, shift = 0.0;
  while (n < 0 || n > last) {
    if (last == 0) return x[0];
    const double end = n < 0 ? x.front() : x.back();
    shift += sign * 2.0 * end;
    sign = -sign;
    n = n < 0 ? -n : 2 * last - n;
  }
  return shift + sign * x[static_cast<std::size_t>(n)];
}

void require_window(std::size_t samples, int begin, int end) {
  if (begin < 0 || begin >= end || static_cast<std::size_t>(end) > samples)
    throw std::invalid_argument("window = [" + std::to_string(begin) + ", " + std::to_string(end) +
                                "), must lie within [0, " + std::to_string(samples) + ")");
}

void require_factor(int factor) {
  if (factor < 1)
    throw std::invalid_argument("factor = " + std::to_string(factor) + ", must be >= 1");
}

}  // namespace

Spectrum welch(std::span<const double> x, double sample_rate_hz, WelchOptions options) {
  CrossSpectra s = cross_spectra(x, x, sample_rate_hz, options);
  return {std::move(s.frequencies_hz), std::move(s.xx), s.segments};
}

FrequencyResponse frequency_response(std::span<const double> x, std::span<const double> y,
                                     double sample_rate_hz, WelchOptions options) {
  CrossSpectra s = cross_spectra(x, y, sample_rate_hz, options);
  FrequencyResponse response{.frequencies_hz = std::move(s.frequencies_hz),
                             .h1 = {},
                             .h2 = {},
                             .coherence = {},
                             .segments = s.segments};
  for (std::size_t i = 0; i < s.xx.size(); ++i) {
    response.h1.push_back(s.xy[i] / s.xx[i]);
    response.h2.push_back(s.yy[i] / std::conj(s.xy[i]));
    response.coherence.push_back(std::norm(s.xy[i]) / (s.xx[i] * s.yy[i]));
  }
  return response;
}

SpectrumComparison compare_window(std::span<const double> record, int begin, int end,
                                  double sample_rate_hz, WelchOptions options) {
  require_window(record.size(), begin, end);
  const auto part =
      record.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  options.segment = std::min(options.segment, end - begin);
  SpectrumComparison result{.full = welch(record, sample_rate_hz, options),
                            .window = welch(part, sample_rate_hz, options)};
  const double power = variance(record);
  result.power_ratio = variance(part) / power;

  // Selects the strongest spectral lines that together contain 99.9 % of the power. The first line
  // is excluded, because it contains the remainder of the means.
  std::vector<std::size_t> lines(result.full.density.size() - 1);
  std::iota(lines.begin(), lines.end(), 1);
  std::sort(lines.begin(), lines.end(), [&](std::size_t i, std::size_t j) {
    return result.full.density[i] > result.full.density[j];
  });
  double total = 0.0, covered = 0.0, squares = 0.0;
  for (std::size_t i : lines) total += result.full.density[i];
  int used = 0;
  for (std::size_t i : lines) {
    if (covered >= 0.999 * total) break;
    covered += result.full.density[i];
    const double db = 10.0 * std::log10(result.window.density[i] / result.full.density[i]);
    squares += db * db;
    ++used;
  }
  result.difference_db = used > 0 ? std::sqrt(squares / used) : 0.0;
  // A mean of K Hann periodograms with 50 % overlap has a relative standard deviation of √(19 / (18
  // K)) (Welch 1967).
  const auto scatter = [](const Spectrum& s) { return 19.0 / (18.0 * s.segments); };
  result.expected_db =
      10.0 / std::numbers::ln10 * std::sqrt(scatter(result.full) + scatter(result.window));
  return result;
}

double linear_interpolation_loss(const Spectrum& spectrum, double sample_rate_hz) {
  double kept = 0.0, total = 0.0;
  for (std::size_t i = 0; i < spectrum.density.size(); ++i) {
    const double gain = sinc(spectrum.frequencies_hz[i] / sample_rate_hz);
    kept += spectrum.density[i] * std::pow(gain, 4);
    total += spectrum.density[i];
  }
  return total > 0.0 ? 1.0 - std::sqrt(kept / total) : 0.0;
}

void detrend(std::span<double> x, int degree) {
  if (degree != 0 && degree != 1)
    throw std::invalid_argument("degree = " + std::to_string(degree) + ", must be 0 or 1");
  if (x.empty()) return;
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n, middle = 0.5 * (n - 1.0);
  double slope = 0.0;
  if (degree == 1 && x.size() > 1) {
    for (std::size_t i = 0; i < x.size(); ++i) slope += (static_cast<double>(i) - middle) * x[i];
    slope *= 12.0 / (n * (n * n - 1.0));
  }
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] -= mean + slope * (static_cast<double>(i) - middle);
}

std::vector<double> upsample(std::span<const double> record, int begin, int end, int factor) {
  require_window(record.size(), begin, end);
  require_factor(factor);
  constexpr int kReach = 32;
  constexpr double kBeta = 12.0;
  const auto size = static_cast<std::size_t>((end - begin - 1) * factor + 1);
  std::vector<double> out(size);
  std::vector<double> weights(2 * kReach);
  for (int phase = 0; phase < factor; ++phase) {
    const double shift = static_cast<double>(phase) / factor;
    double sum = 0.0;
    for (int k = 0; k < 2 * kReach; ++k) {
      const double distance = shift - (k - kReach + 1);
      sum += weights[static_cast<std::size_t>(k)] =
          sinc(distance) * kaiser(distance / kReach, kBeta);
    }
    for (double& w : weights) w /= sum;  // preserves a constant exactly
    for (std::size_t n = static_cast<std::size_t>(phase), m = 0; n < size;
         n += static_cast<std::size_t>(factor), ++m) {
      const std::ptrdiff_t centre = begin + static_cast<std::ptrdiff_t>(m);
      if (phase == 0) {
        out[n] = record[static_cast<std::size_t>(centre)];
        continue;
      }
      double value = 0.0;
      for (int k = 0; k < 2 * kReach; ++k)
        value += weights[static_cast<std::size_t>(k)] * reflected(record, centre + k - kReach + 1);
      out[n] = value;
    }
  }
  return out;
}

std::vector<double> decimate(std::span<const double> x, int factor) {
  require_factor(factor);
  if (factor == 1) return {x.begin(), x.end()};
  const int reach = 32 * factor;
  const double cutoff = 0.45 / factor;  // cycles per old sample
  std::vector<double> weights(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k)
    sum += weights[static_cast<std::size_t>(k + reach)] =
        sinc(2.0 * cutoff * k) * kaiser(static_cast<double>(k) / reach, 9.0);
  std::vector<double> out;
  for (std::size_t n = 0; n < x.size(); n += static_cast<std::size_t>(factor)) {
    double value = 0.0;
    for (int k = -reach; k <= reach; ++k)
      value += weights[static_cast<std::size_t>(k + reach)] *
               reflected(x, static_cast<std::ptrdiff_t>(n) + k);
    out.push_back(value / sum);
  }
  return out;
}

std::vector<SpectralLevel> spectral_levels(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                           double sample_rate_hz, double lowest_hz,
                                           double highest_hz) {
  const auto n = static_cast<int>(records.cols());
  int segment = 64;
  while (segment * 8 <= n && segment < 16384) segment *= 2;
  std::vector<SpectralLevel> out;
  for (Eigen::Index c = 0; c < records.rows(); ++c) {
    const Eigen::VectorXd x = records.row(c).transpose();
    const Spectrum s =
        welch({x.data(), static_cast<std::size_t>(x.size())}, sample_rate_hz, {.segment = segment});
    const double variance = (x.array() - x.mean()).square().mean();
    if (out.empty())
      for (const double f : s.frequencies_hz) out.push_back({f, 0.0});
    for (std::size_t i = 0; i < out.size(); ++i) out[i].level_db += s.density[i] / variance;
  }
  std::erase_if(out, [&](const SpectralLevel& l) {
    return l.frequency_hz < lowest_hz || l.frequency_hz > highest_hz || !(l.level_db > 0.0);
  });
  for (SpectralLevel& l : out) l.level_db = 10.0 * std::log10(l.level_db);
  return out;
}

std::vector<SpectralLevel> highest_lines(const std::vector<SpectralLevel>& levels,
                                         std::size_t most) {
  const std::size_t width = (levels.size() + most - 1) / most;
  std::vector<SpectralLevel> out;
  for (std::size_t from = 0; from < levels.size(); from += width) {
    const auto begin = levels.begin() + static_cast<std::ptrdiff_t>(from);
    const auto end =
        levels.begin() + static_cast<std::ptrdiff_t>(std::min(from + width, levels.size()));
    out.push_back(*std::ranges::max_element(begin, end, {}, &SpectralLevel::level_db));
  }
  return out;
}

}  // namespace wheeltap::signals
