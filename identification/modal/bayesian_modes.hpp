// Bayesian operational modal analysis: the modes of a band and their posterior, from the Fourier
// transform of a record.
//
// Au 2011, "Fast Bayesian FFT method for ambient modal identification with separated modes", J.
// Eng. Mech. 137:214; Au 2012, MSSP 26:60 and 76 (close modes); Au 2017, Operational Modal
// Analysis, chapters 10 to 13.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "inference/model/target.hpp"
#include "signals/modal/modal_identification.hpp"

namespace wheeltap::identification {

/// A band and the modes that it holds, as a look at the spectra tells.
struct ModalBand {
  double lowest_hz = 0.0, highest_hz = 0.0;
  std::vector<double> peaks_hz = {};  ///< about where each mode is, ascending; one to three
};

/// Fourier lines of accelerations in a band.
struct BandLines {
  Eigen::VectorXd frequencies_hz;
  /// channels × lines: F_k = √(2 Δt/N) Σ_j y_j e^{-2πi jk/N}, so that E F Fᴴ is the one-sided
  /// spectral density [unit² / Hz].
  Eigen::MatrixXcd transform;
};

/// `records`: a channel a row, freed of their means here. Throws std::invalid_argument for a band
/// beyond what the sampling holds, and for fewer lines than `kFewestLines` a mode.
[[nodiscard]] BandLines band_lines(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                   double sample_rate_hz, const ModalBand& band);

/// ln p(F | θ) = -Σ_k ln |E_k| - Σ_k F_kᴴ E_k⁻¹ F_k + const,
///
///   E_k = Φ diag(h_k) S diag(h_k)ᴴ Φᵀ + S_e I,   h_ik = 1 / (1 - β_ik² - 2 i ζ_i β_ik),
///   β_ik = f_i / f_k,
///
/// of m modes with shapes Φ of unit length, modal forces (over modal mass) of spectral density S
/// (m × m, Hermitian) and sensor noise S_e, both constant over the band. What the modes beyond the
/// band do in it is noise here: bands should be where their own modes stand out.
///
/// θ: f and ζ of each mode; its shape u + T b, scaled to unit length, b of n - 1 numbers, u the
/// direction of the spectral matrix at the mode's peak and T what is orthogonal to it; the diagonal
/// of S; its coherences as rows of a lower triangle, unit on the diagonal, scaled to unit length;
/// S_e. Priors: f uniform in the band, ζ log-uniform on [1e-4, 0.2], b standard normal, what S and
/// S_e scale with log-uniform over ten decades, the triangle's entries standard normal.
class BandProblem {
 public:
  static constexpr int kFewestLines = 20;

  /// Throws std::invalid_argument for bands without modes, with more than three, with peaks that
  /// lie outside or do not ascend, or with too few lines.
  BandProblem(BandLines lines, ModalBand band);

  [[nodiscard]] int modes() const { return static_cast<int>(band_.peaks_hz.size()); }
  [[nodiscard]] int channels() const { return static_cast<int>(lines_.transform.rows()); }
  [[nodiscard]] const std::vector<inference::Parameter>& parameters() const { return parameters_; }
  /// -∞ where frequencies do not ascend.
  [[nodiscard]] double log_likelihood(std::span<const double> x) const;
  /// n × m, each of unit length.
  [[nodiscard]] Eigen::MatrixXd shapes(std::span<const double> x) const;
  /// One model. Refers to this object.
  [[nodiscard]] inference::Problem problem() const;

 private:
  BandLines lines_;
  ModalBand band_;
  std::vector<inference::Parameter> parameters_;
  std::vector<Eigen::VectorXd> directions_;   // u of each mode
  std::vector<Eigen::MatrixXd> complements_;  // T
  double power_ = 0.0;                        // Σ |F|²
};

/// The posterior of a band's modes, in short.
struct BayesianBand {
  Eigen::VectorXd frequencies_hz, damping;         ///< means
  Eigen::MatrixXd covariance;                      ///< of all frequencies, then all damping ratios
  Eigen::MatrixXd shapes;                          ///< n × m, largest entry 1: means of the draws
  std::vector<Eigen::MatrixXd> shape_covariances;  ///< n × n, of shapes so scaled
  bool converged = false;
  std::vector<std::string> not_established = {};
  long likelihood_evaluations = 0;
};

struct BayesianBandOptions {
  std::uint64_t seed = 1;
  int warmup = 2000, draws = 1500, searches = 10;  ///< as in inference::Options
  int threads = 0;
};

/// Samples the band's posterior with the engine of inference/.
[[nodiscard]] BayesianBand identify_band(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                         double sample_rate_hz, const ModalBand& band,
                                         const BayesianBandOptions& options = {});

/// All bands, one after another; modes by frequency. Those of different bands are independent.
/// Throws as `band_lines` and BandProblem do, naming the band (from 0), and for bands that overlap.
[[nodiscard]] signals::ModalResult identify_bands(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                                  double sample_rate_hz,
                                                  const std::vector<ModalBand>& bands,
                                                  const BayesianBandOptions& options = {});

}  // namespace wheeltap::identification
