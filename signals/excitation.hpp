// Excitations for simulated experiments. With the same seed, the signal is the same on every
// computer.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace wheeltap::signals {

/// A generator of uniform and normal random numbers. The numbers do not depend on the
/// implementation of the standard library.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : generator_(seed) {}
  double uniform();  ///< uniform distribution on (0, 1)
  double normal();   ///< standard normal distribution (Box & Muller 1958)

 private:
  std::mt19937_64 generator_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Draws independent normal samples with mean 0 and the given variance.
[[nodiscard]] std::vector<double> white_noise(int samples, double variance, Noise& noise);

/// Draws Gaussian noise with a flat spectrum on [low_hz, high_hz] and a spectrum of zero outside
/// this band. `variance` is the expected variance of the noise. The noise is a section of a longer
/// periodic signal, so that the noise is not periodic itself. Throws std::invalid_argument unless 0
/// <= low_hz < high_hz <= sample_rate_hz / 2 and the band contains a spectral line of the periodic
/// signal.
[[nodiscard]] std::vector<double> band_limited_noise(int samples, double sample_rate_hz,
                                                     double low_hz, double high_hz, double variance,
                                                     Noise& noise);

/// Computes the samples of amplitude · sin(2π f t + phase), with the phase in rad.
[[nodiscard]] std::vector<double> sine(int samples, double sample_rate_hz, double amplitude,
                                       double frequency_hz, double phase = 0.0);

/// A multisine: a periodic sum of sines with equal amplitudes and random phases. The frequencies
/// are all multiples of f_s / period in [low_hz, high_hz], where f_s is the sampling rate.
struct Multisine {
  int period = 1024;  ///< samples
  double low_hz = 0.0;
  double high_hz = 0.0;
  double rms = 1.0;
  bool odd_lines_only = false;
};

/// Computes the samples of a multisine with random phases. Throws std::invalid_argument if the band
/// contains no spectral line, or reaches half the sampling rate.
[[nodiscard]] std::vector<double> multisine(int samples, double sample_rate_hz,
                                            const Multisine& options, Noise& noise);

}  // namespace wheeltap::signals
