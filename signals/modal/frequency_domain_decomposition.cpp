#include "signals/modal/frequency_domain_decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int kSegments = 40, kFewestSegments = 8, kSpectrumBlocks = 20, kFewestSpectrumBlocks = 4;
constexpr int kPadding = 2;
constexpr double kOwn = 0.8;                  // smallest MAC with the peak for lines of the mode
constexpr int kFewestLines = 3;               // smallest number of lines of a peak, unpadded
constexpr double kUpper = 0.9, kLower = 0.3;  // range of |c| for the fit of the decay
constexpr int kFewestCorrelationLags = 8;
constexpr double kLeastDecibels = 3.0;

/// S(f) at the lines from `first` on, summed over the segments of a part of the record.
struct Part {
  std::vector<MatrixXcd> lines;
  int segments = 0;
};

struct Spectra {
  double spacing_hz = 0.0;  ///< spacing of the padded lines
  Index first = 0;
  std::vector<Part> parts = {};

  [[nodiscard]] Index lines() const { return static_cast<Index>(parts.front().lines.size()); }
  [[nodiscard]] double frequency(Index line) const {
    return static_cast<double>(first + line) * spacing_hz;
  }
  /// The mean of all parts except `without`; -1: of all parts.
  [[nodiscard]] MatrixXcd mean(Index line, int without) const {
    const Index n = parts.front().lines.front().rows();
    MatrixXcd sum = MatrixXcd::Zero(n, n);
    int segments = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (static_cast<int>(p) == without) continue;
      sum += parts[p].lines[index(line)];
      segments += parts[p].segments;
    }
    return sum / segments;
  }
};

VectorXd hann(int segment) {
  VectorXd w(segment);
  for (Index i = 0; i < w.size(); ++i)
    w[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / segment);
  return w;
}

Spectra spectra_of(const MatrixXd& y, const ModalResult& band, int parts, int threads) {
  const int segment = band.segment, padded = kPadding * segment;
  Spectra out{.spacing_hz = band.sample_rate_hz / padded};
  out.first = std::max<Index>(1, static_cast<Index>(std::ceil(band.lowest_hz / out.spacing_hz)));
  const Index last = std::min<Index>(
      padded / 2 - 1, static_cast<Index>(std::floor(band.highest_hz / out.spacing_hz)));
  if (last - out.first < kPadding * kFewestLines)
    throw std::invalid_argument("segment = " + std::to_string(segment) +
                                ": the band contains too few of its spectral lines");
  const VectorXd window = hann(segment);
  out.parts.resize(index(parts));
  base::parallel_for(parts, threads, [&](int p) {
    Part& part = out.parts[index(p)];
    part.lines.assign(index(last - out.first + 1), MatrixXcd::Zero(y.rows(), y.rows()));
    Eigen::FFT<double> fft;
    MatrixXcd lines(y.rows(), last - out.first + 1);
    const long begin = static_cast<long>(band.segments) * p / parts,
               end = static_cast<long>(band.segments) * (p + 1) / parts;
    for (long s = begin; s < end; ++s) {
      const Index from = s * (segment / 2);
      for (Index c = 0; c < y.rows(); ++c) {
        VectorXcd in = VectorXcd::Zero(padded), transformed;
        const VectorXd x = y.row(c).segment(from, segment).transpose();
        in.head(segment) = (window.array() * (x.array() - x.mean())).matrix().cast<Complex>();
        fft.fwd(transformed, in);
        lines.row(c) = transformed.segment(out.first, lines.cols()).transpose();
      }
      for (Index l = 0; l < lines.cols(); ++l)
        part.lines[index(l)] += lines.col(l) * lines.col(l).adjoint();
      ++part.segments;
    }
  });
  return out;
}

struct First {
  double value = 0.0;
  VectorXcd shape;
};

First first_of(const MatrixXcd& s) {
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(s);
  const Index n = s.rows() - 1;
  return {.value = std::max(solver.eigenvalues()[n], 0.0), .shape = solver.eigenvectors().col(n)};
}

/// A peak and the neighbouring lines with the same shape.
struct Peak {
  Index line = 0, begin = 0, end = 0;
};

/// Finds the lines [begin, end) around `line` with the same shape as `line`.
Peak domain_of(const std::vector<First>& firsts, Index line) {
  const auto own = [&](Index l) {
    return modal_assurance(firsts[index(l)].shape, firsts[index(line)].shape) > kOwn;
  };
  Peak out{.line = line, .begin = line, .end = line + 1};
  while (out.begin > 0 && own(out.begin - 1)) --out.begin;
  while (out.end < static_cast<Index>(firsts.size()) && own(out.end)) ++out.end;
  return out;
}

/// Prominence [dB] of a line: its height above the lowest line between it and a higher line.
double prominence(const std::vector<First>& firsts, Index line) {
  const double own = firsts[index(line)].value;
  const auto least_to = [&](Index step) {
    double least = own;
    for (Index l = line + step; l >= 0 && l < static_cast<Index>(firsts.size()); l += step) {
      if (firsts[index(l)].value > own) return least;
      least = std::min(least, firsts[index(l)].value);
    }
    return least;
  };
  return 10.0 * std::log10(own / std::max({least_to(-1), least_to(1), 1e-300}));
}

std::vector<Peak> peaks_of(const std::vector<First>& firsts, int segments) {
  const double scatter = std::min(3.0 / std::sqrt(static_cast<double>(segments)), 0.9);
  const double least =
      std::max(kLeastDecibels, 10.0 * std::log10((1.0 + scatter) / (1.0 - scatter)));
  std::vector<Peak> out;
  for (Index l = 1; l + 1 < static_cast<Index>(firsts.size()); ++l) {
    const double own = firsts[index(l)].value;
    if (!(own >= firsts[index(l - 1)].value && own > firsts[index(l + 1)].value)) continue;
    if (prominence(firsts, l) < least) continue;
    const Peak peak = domain_of(firsts, l);
    if (peak.end - peak.begin >= kPadding * kFewestLines) out.push_back(peak);
  }
  return out;
}

/// Computes λ from the lines of one mode; NaN if the correlation function does not decay.
Complex decay_of(const VectorXd& bell, Index first, double step, int segment) {
  const int padded = kPadding * segment;
  VectorXcd in = VectorXcd::Zero(padded), c;
  in.segment(first, bell.size()) = bell.cast<Complex>();
  Eigen::FFT<double> fft;
  fft.inv(c, in);
  // The correlation function of the window.
  VectorXcd w = VectorXcd::Zero(padded), spectrum, own;
  w.head(segment) = hann(segment).cast<Complex>();
  fft.fwd(spectrum, w);
  spectrum = spectrum.cwiseAbs2().cast<Complex>();
  fft.inv(own, spectrum);
  std::vector<double> times, sizes, phases;
  double phase = std::arg(c[0]), largest = std::abs(c[0]) / own[0].real();
  for (Index k = 1; k < segment / 2; ++k) {
    phase += std::arg(c[k] / c[k - 1]);
    const double size = std::abs(c[k]) / own[k].real() / largest;
    if (size < kLower) break;
    if (size > kUpper) continue;
    times.push_back(step * static_cast<double>(k));
    sizes.push_back(std::log(size));
    phases.push_back(phase);
  }
  const auto n = static_cast<Index>(times.size());
  if (n < kFewestCorrelationLags) return {kNaN, kNaN};
  const Eigen::Map<const VectorXd> t(times.data(), n), a(sizes.data(), n), b(phases.data(), n);
  const VectorXd centred = t.array() - t.mean();
  const double scale = centred.squaredNorm();
  return {centred.dot(a) / scale, centred.dot(b) / scale};
}

struct Estimate {
  Complex eigenvalue = {kNaN, kNaN};
  VectorXcd shape;
};

/// The mode of a peak, from the record without one part.
Estimate estimate(const Spectra& spectra, const ModalResult& band, const Peak& peak, int without) {
  const First top = first_of(spectra.mean(peak.line, without));
  VectorXd bell(peak.end - peak.begin);
  for (Index l = peak.begin; l < peak.end; ++l) {
    const First one = first_of(spectra.mean(l, without));
    bell[l - peak.begin] = one.value;
  }
  return {.eigenvalue =
              decay_of(bell, spectra.first + peak.begin, 1.0 / band.sample_rate_hz, band.segment),
          .shape = top.shape};
}

double frequency_of(Complex lambda) {
  return std::abs(lambda) / (2.0 * std::numbers::pi);
}
double damping_of(Complex lambda) {
  return -lambda.real() / std::abs(lambda);
}

VectorXcd scaled(const VectorXcd& shape, Index top) {
  return shape / shape[top];
}

/// Computes frequency, damping and covariances of peaks with a decay. Omits all other peaks.
void enhance(ModalResult& out, const Spectra& spectra, std::vector<Peak>& peaks, int threads) {
  const auto parts = static_cast<int>(spectra.parts.size());
  std::vector<std::vector<Estimate>> all(peaks.size());
  base::parallel_for(static_cast<int>(peaks.size()), threads, [&](int m) {
    for (int without = -1; without < parts; ++without)
      all[index(m)].push_back(estimate(spectra, out, peaks[index(m)], without));
  });
  std::vector<std::size_t> kept;
  for (std::size_t m = 0; m < peaks.size(); ++m)
    if (std::ranges::all_of(all[m], [](const Estimate& e) { return e.eigenvalue.real() < 0.0; }))
      kept.push_back(m);
  const auto count = static_cast<Index>(kept.size());
  const Index channels = spectra.parts.front().lines.front().rows();
  MatrixXd values(2 * count, parts);
  std::vector<Mode> modes;
  for (Index m = 0; m < count; ++m) {
    const std::vector<Estimate>& of = all[kept[index(m)]];
    Mode mode = out.modes[kept[index(m)]];
    Index top = 0;
    of[0].shape.cwiseAbs().maxCoeff(&top);
    MatrixXd shapes(2 * channels, parts);
    for (int p = 0; p < parts; ++p) {
      const Estimate& one = of[index(p) + 1];
      values(m, p) = frequency_of(one.eigenvalue);
      values(count + m, p) = damping_of(one.eigenvalue);
      const VectorXcd shape = scaled(one.shape, top);
      shapes.col(p) << shape.real(), shape.imag();
    }
    shapes.colwise() -= shapes.rowwise().mean().eval();
    mode.pole.eigenvalue = of[0].eigenvalue;
    mode.pole.frequency_hz = frequency_of(of[0].eigenvalue);
    mode.pole.damping = damping_of(of[0].eigenvalue);
    mode.shape_covariance = shapes * shapes.transpose() * ((parts - 1.0) / parts);
    modes.push_back(std::move(mode));
  }
  values.colwise() -= values.rowwise().mean().eval();
  out.covariance = values * values.transpose() * ((parts - 1.0) / parts);
  for (Index m = 0; m < count; ++m) {
    modes[index(m)].pole.frequency_sd = std::sqrt(out.covariance(m, m));
    modes[index(m)].pole.damping_sd = std::sqrt(out.covariance(count + m, count + m));
  }
  out.modes = std::move(modes);
}

}  // namespace

ModalResult decompose_spectra(const Eigen::Ref<const MatrixXd>& records,
                              const DecompositionOptions& options) {
  ModalResult out{.method = options.enhanced ? ModalMethod::enhanced : ModalMethod::decomposition,
                  .lowest_hz = options.lowest_hz,
                  .highest_hz = options.highest_hz};
  const MatrixXd y = records_of_band(records, options.sample_rate_hz, options.threads, out);
  for (Index c = 0; c < y.rows(); ++c)
    if (!y.row(c).allFinite() || !((y.row(c).array() - y(c, 0)).abs().maxCoeff() > 0.0))
      throw ChannelError(c, "must be finite and must change");
  out.segment = 16;
  while (out.segment * (kSegments + 1) <= y.cols()) out.segment *= 2;
  if (options.segment > 0) out.segment = std::max(16, options.segment / out.decimated / 2 * 2);
  out.segments = static_cast<int>(2 * y.cols() / out.segment) - 1;
  if (out.segments < kFewestSegments)
    throw std::invalid_argument(
        "segment = " + std::to_string(out.segment) +
        ": the record must hold at least eight segments, with 50 % overlap, "
        "after decimation to the band");
  out.blocks = std::clamp(options.blocks > 0 ? options.blocks : kSpectrumBlocks,
                          kFewestSpectrumBlocks, std::max(kFewestSpectrumBlocks, out.segments / 2));
  const Spectra spectra = spectra_of(y, out, out.blocks, options.threads);
  std::vector<First> firsts(index(spectra.lines()));
  base::parallel_for(static_cast<int>(firsts.size()), options.threads,
                     [&](int l) { firsts[index(l)] = first_of(spectra.mean(l, -1)); });
  out.lines = static_cast<long>(firsts.size());
  out.singular_spectrum.resize(spectra.lines(), 2);
  for (Index l = 0; l < spectra.lines(); ++l)
    out.singular_spectrum.row(l) << spectra.frequency(l), firsts[index(l)].value;
  std::vector<Peak> peaks = peaks_of(firsts, out.segments);
  for (const Peak& peak : peaks) {
    const VectorXcd& found = firsts[index(peak.line)].shape;
    Index top = 0, strongest = 0;
    found.cwiseAbs().maxCoeff(&top);
    (found.array().abs() / y.rowwise().norm().array()).maxCoeff(&strongest);
    const double f = spectra.frequency(peak.line);
    const VectorXcd shape = scaled(found, top);
    Mode mode;
    mode.pole.eigenvalue = {kNaN, 2.0 * std::numbers::pi * f};
    mode.pole.frequency_hz = f;
    mode.pole.damping = mode.pole.frequency_sd = mode.pole.damping_sd = kNaN;
    mode.pole.shape = shape;
    mode.collinearity = phase_collinearity(shape);
    mode.phase_deviation = mean_phase_deviation(shape);
    mode.amplitude_kurtosis =
        amplitude_kurtosis(y.row(strongest).transpose(), f, out.sample_rate_hz);
    out.modes.push_back(std::move(mode));
  }
  if (options.enhanced) enhance(out, spectra, peaks, options.threads);
  if (!options.enhanced) out.blocks = 0;
  doubt_modes(out);
  return out;
}

}  // namespace wheeltap::signals
