#include "signals/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

#include "base/constants.hpp"

namespace wheeltap::signals {

namespace {

using Complex = std::complex<double>;

void require_samples(int samples, double rate) {
  if (samples < 1)
    throw std::invalid_argument("samples = " + std::to_string(samples) + ", must be >= 1");
  if (!(rate > 0.0))
    throw std::invalid_argument("sample rate = " + std::to_string(rate) + " Hz, must be > 0");
}

void require_band(double low, double high, double rate) {
  if (!(low >= 0.0 && low < high && high <= 0.5 * rate))
    throw std::invalid_argument("band = [" + std::to_string(low) + ", " + std::to_string(high) +
                                "] Hz, must be increasing and within [0, " +
                                std::to_string(0.5 * rate) + "]");
}

/// Computes one period of the signal Σ Re(lines[k] e^{2πi k n / N}).
std::vector<double> synthesise(std::vector<Complex> lines) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::Unscaled);
  std::vector<Complex> out;
  fft.inv(out, lines);
  std::vector<double> x(lines.size());
  for (std::size_t n = 0; n < x.size(); ++n) x[n] = out[n].real();
  return x;
}

}  // namespace

double Noise::uniform() {
  return (static_cast<double>(generator_() >> 11) + 0.5) * 0x1.0p-53;
}

double Noise::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  const double angle = 2.0 * kPi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

std::vector<double> white_noise(int samples, double variance, Noise& noise) {
  require_samples(samples, 1.0);
  if (!(variance >= 0.0))
    throw std::invalid_argument("variance = " + std::to_string(variance) + ", must be >= 0");
  std::vector<double> x(static_cast<std::size_t>(samples));
  const double sigma = std::sqrt(variance);
  for (double& value : x) value = sigma * noise.normal();
  return x;
}

std::vector<double> band_limited_noise(int samples, double sample_rate_hz, double low_hz,
                                       double high_hz, double variance, Noise& noise) {
  require_samples(samples, sample_rate_hz);
  require_band(low_hz, high_hz, sample_rate_hz);
  if (!(variance >= 0.0))
    throw std::invalid_argument("variance = " + std::to_string(variance) + ", must be >= 0");
  std::size_t period = 64;
  while (period < 2 * static_cast<std::size_t>(samples)) period *= 2;
  const double spacing = sample_rate_hz / static_cast<double>(period);
  const auto first =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(low_hz / spacing)));
  const auto last =
      std::min(period / 2 - 1, static_cast<std::size_t>(std::floor(high_hz / spacing)));
  if (first > last)
    throw std::invalid_argument("the band [" + std::to_string(low_hz) + ", " +
                                std::to_string(high_hz) + "] Hz is too narrow for this record");
  // A line a + ib contributes the variance (E a² + E b²) / 2.
  const double sigma = std::sqrt(variance / static_cast<double>(last - first + 1));
  std::vector<Complex> lines(period, 0.0);
  for (std::size_t k = first; k <= last; ++k) {
    const double real = noise.normal();
    lines[k] = sigma * Complex(real, noise.normal());
  }
  std::vector<double> x = synthesise(std::move(lines));
  x.resize(static_cast<std::size_t>(samples));
  return x;
}

std::vector<double> sine(int samples, double sample_rate_hz, double amplitude, double frequency_hz,
                         double phase) {
  require_samples(samples, sample_rate_hz);
  std::vector<double> x(static_cast<std::size_t>(samples));
  for (std::size_t n = 0; n < x.size(); ++n)
    x[n] = amplitude *
           std::sin(2.0 * kPi * frequency_hz * static_cast<double>(n) / sample_rate_hz + phase);
  return x;
}

std::vector<double> multisine(int samples, double sample_rate_hz, const Multisine& options,
                              Noise& noise) {
  require_samples(samples, sample_rate_hz);
  require_band(options.low_hz, options.high_hz, sample_rate_hz);
  if (options.period < 2)
    throw std::invalid_argument("period = " + std::to_string(options.period) + ", must be >= 2");
  const auto period = static_cast<std::size_t>(options.period);
  std::vector<Complex> lines(period, 0.0);
  int count = 0;
  for (std::size_t k = 1; 2 * k < period; ++k) {
    const double f = static_cast<double>(k) * sample_rate_hz / static_cast<double>(period);
    if (f < options.low_hz || f > options.high_hz || (options.odd_lines_only && k % 2 == 0))
      continue;
    lines[k] = std::polar(1.0, 2.0 * kPi * noise.uniform());
    ++count;
  }
  if (count == 0)
    throw std::invalid_argument("no spectral line of a multisine with a period of " +
                                std::to_string(options.period) + " samples lies in its band");
  for (Complex& line : lines) line *= options.rms * std::sqrt(2.0 / count);
  const std::vector<double> one = synthesise(std::move(lines));
  std::vector<double> x(static_cast<std::size_t>(samples));
  for (std::size_t n = 0; n < x.size(); ++n) x[n] = one[n % period];
  return x;
}

}  // namespace wheeltap::signals
