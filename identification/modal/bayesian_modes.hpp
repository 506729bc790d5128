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

/// A frequency band, and approximate frequencies of its modes as read from the spectra.
struct ModalBand {
  double lowest_hz = 0.0, highest_hz = 0.0;
  std::vector<double> peaks_hz = {};  ///< approximate frequencies of one to three modes, ascending
};

/// Fourier coefficients of accelerations in a frequency band.
struct BandLines {
  Eigen::VectorXd frequencies_hz;
  /// Matrix (channels × lines) with the columns F_k = √(2 Δt/N) Σ_j y_j e^{-2πi jk/N}. With this
  /// scale, E[F_k F_kᴴ] is the one-sided spectral density [unit² / Hz].
  Eigen::MatrixXcd transform;
};

/// Computes the Fourier coefficients of a band. `records` has one channel per row; the function
/// subtracts the mean values. Throws std::invalid_argument if the band exceeds half the sampling
/// rate, or contains fewer than `kFewestLines` spectral lines per mode.
[[nodiscard]] BandLines band_lines(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                   double sample_rate_hz, const ModalBand& band);

/// The likelihood of a band with m modes, whose shapes Φ have unit length:
///
///   ln p(F | θ) = -Σ_k ln |E_k| - Σ_k F_kᴴ E_k⁻¹ F_k + const,
///   E_k = Φ diag(h_k) S diag(h_k)ᴴ Φᵀ + S_e I,   h_ik = 1 / (1 - β_ik² - 2 i ζ_i β_ik),
///   β_ik = f_i / f_k,
///
/// S is the spectral density of the modal forces divided by modal mass (m × m, Hermitian). S_e is
/// the spectral density of the sensor noise. S and S_e are constant over the band. Contributions of
/// other modes count as noise, so the modes of the band should dominate the spectrum in the band.
///
/// Parameters θ:
/// - frequency f and damping ratio ζ of each mode;
/// - n - 1 numbers b per mode: the shape is u + T b, scaled to unit length; u is the dominant
///   eigenvector of the spectral matrix at the mode's peak, T a basis orthogonal to u;
/// - the diagonal of S;
/// - the coherences of S: a lower triangle with unit diagonal, each row scaled to unit length;
/// - S_e.
///
/// Priors: f uniform in the band, ζ log-uniform on [1e-4, 0.2], b standard normal, S_e and the
/// diagonal of S log-uniform over ten decades, entries of the triangle standard normal.
class BandProblem {
 public:
  static constexpr int kFewestLines = 20;

  /// Throws std::invalid_argument unless the band has one to three modes, enough spectral lines,
  /// and ascending peaks inside the band.
  BandProblem(BandLines lines, ModalBand band);

  [[nodiscard]] int modes() const { return static_cast<int>(band_.peaks_hz.size()); }
  [[nodiscard]] int channels() const { return static_cast<int>(lines_.transform.rows()); }
  [[nodiscard]] const std::vector<inference::Parameter>& parameters() const { return parameters_; }
  /// Log likelihood of the parameters x, -∞ if the frequencies are not in ascending order.
  [[nodiscard]] double log_likelihood(std::span<const double> x) const;
  /// Mode shapes, n × m, each of unit length.
  [[nodiscard]] Eigen::MatrixXd shapes(std::span<const double> x) const;
  /// The inference problem of the band, with one model. The problem refers to this object.
  [[nodiscard]] inference::Problem problem() const;

 private:
  BandLines lines_;
  ModalBand band_;
  std::vector<inference::Parameter> parameters_;
  std::vector<Eigen::VectorXd> directions_;   // direction u of each mode
  std::vector<Eigen::MatrixXd> complements_;  // orthogonal complement T of each direction
  double power_ = 0.0;                        // total power Σ |F|²
};

/// Summary of the posterior of a band's modes.
struct BayesianBand {
  Eigen::VectorXd frequencies_hz, damping;  ///< posterior means
  /// Joint covariance: first all frequencies, then all damping ratios
  Eigen::MatrixXd covariance;
  /// Posterior mean shapes, n × m, with the largest entry 1
  Eigen::MatrixXd shapes;
  /// n × n covariance of each shape in `shapes`
  std::vector<Eigen::MatrixXd> shape_covariances;
  bool converged = false;
  std::vector<std::string> not_established = {};
  long likelihood_evaluations = 0;
};

struct BayesianBandOptions {
  std::uint64_t seed = 1;
  /// Options of the sampler, as in inference::Options
  int warmup = 2000, draws = 1500, searches = 10;
  int threads = 0;
};

/// Samples the posterior of one band by reversible-jump MCMC (inference/).
[[nodiscard]] BayesianBand identify_band(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                         double sample_rate_hz, const ModalBand& band,
                                         const BayesianBandOptions& options = {});

/// Identifies all bands in turn and sorts the modes by frequency. Modes in different bands are
/// assumed to be independent a posteriori. Throws the exceptions of `band_lines` and BandProblem
/// with the number of the band (from 0), and std::invalid_argument for bands that overlap.
[[nodiscard]] signals::ModalResult identify_bands(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                                  double sample_rate_hz,
                                                  const std::vector<ModalBand>& bands,
                                                  const BayesianBandOptions& options = {});

}  // namespace wheeltap::identification
