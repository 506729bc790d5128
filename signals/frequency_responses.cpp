#include "signals/frequency_responses.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

#include "base/eigen_solvers.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

}  // namespace

FrequencyResponses FrequencyResponses::band(double lowest_hz, double highest_hz) const {
  FrequencyResponses out{.segments = segments};
  std::vector<Index> kept;
  for (Index k = 0; k < lines(); ++k)
    if (frequencies_hz[k] >= lowest_hz && frequencies_hz[k] <= highest_hz) kept.push_back(k);
  out.frequencies_hz.resize(static_cast<Index>(kept.size()));
  if (coherence.size() > 0) out.coherence.resize(outputs(), static_cast<Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto to = static_cast<Index>(i);
    out.frequencies_hz[to] = frequencies_hz[kept[i]];
    out.h.push_back(h[static_cast<std::size_t>(kept[i])]);
    if (coherence.size() > 0) out.coherence.col(to) = coherence.col(kept[i]);
  }
  return out;
}

FrequencyResponses estimate_frequency_responses(const Eigen::Ref<const MatrixXd>& inputs,
                                                const Eigen::Ref<const MatrixXd>& outputs,
                                                double sample_rate_hz, int segment) {
  if (!(sample_rate_hz > 0.0)) refuse("sample rate", sample_rate_hz, "must be positive");
  if (inputs.cols() != outputs.cols())
    refuse("samples", static_cast<double>(outputs.cols()),
           "must be those of the inputs, " + std::to_string(inputs.cols()));
  const Index n_in = inputs.rows(), n_out = outputs.rows(), all = n_in + n_out;
  if (n_in < 1 || n_out < 1) refuse("channels", 0, "must be at least one input and one output");
  if (segment == 0) {
    constexpr Index kSegments = 8;
    segment = 16;
    while (2 * segment <= outputs.cols() / kSegments) segment *= 2;
  }
  if (segment < 8) refuse("segment", segment, "must be at least 8 samples");
  const Index length = segment, hop = length / 2;
  const Index segments = inputs.cols() < length ? 0 : (inputs.cols() - length) / hop + 1;
  if (segments < 2 * n_in)
    refuse("samples", static_cast<double>(inputs.cols()),
           "must fill 2 segments of " + std::to_string(segment) + " samples for each input");
  VectorXd hann(length);
  for (Index i = 0; i < length; ++i)
    hann[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) /
                                   static_cast<double>(length));
  const Index lines = length / 2;  // without 0 Hz and the Nyquist frequency
  std::vector<MatrixXcd> spectra(static_cast<std::size_t>(lines - 1), MatrixXcd::Zero(all, all));
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  MatrixXcd transformed(all, lines + 1);
  for (Index s = 0; s < segments; ++s) {
    for (Index c = 0; c < all; ++c) {
      VectorXd piece = (c < n_in ? inputs.row(c) : outputs.row(c - n_in)).segment(s * hop, length);
      piece.array() -= piece.mean();
      piece.array() *= hann.array();
      VectorXcd line;
      fft.fwd(line, piece);
      transformed.row(c) = line.transpose();
    }
    for (Index k = 1; k < lines; ++k)
      spectra[static_cast<std::size_t>(k - 1)] += transformed.col(k) * transformed.col(k).adjoint();
  }
  FrequencyResponses out{.frequencies_hz = VectorXd(lines - 1),
                         .coherence = MatrixXd(n_out, lines - 1),
                         .segments = static_cast<int>(segments)};
  for (Index k = 1; k < lines; ++k) {
    const MatrixXcd& g = spectra[static_cast<std::size_t>(k - 1)];
    out.frequencies_hz[k - 1] =
        sample_rate_hz * static_cast<double>(k) / static_cast<double>(length);
    const MatrixXcd xx = g.topLeftCorner(n_in, n_in), yx = g.bottomLeftCorner(n_out, n_in);
    const Eigen::FullPivLU<MatrixXcd> lu(xx);
    if (!lu.isInvertible())
      refuse("input spectra at", out.frequencies_hz[k - 1],
             "Hz are linearly dependent: an input is zero there, or two are identical");
    out.h.push_back(yx * lu.inverse());
    for (Index o = 0; o < n_out; ++o) {
      const double explained = (out.h.back().row(o) * yx.row(o).adjoint()).real()(0);
      out.coherence(o, k - 1) = explained / g(n_in + o, n_in + o).real();
    }
  }
  return out;
}

}  // namespace wheeltap::signals
