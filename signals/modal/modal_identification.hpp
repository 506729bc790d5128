// Operational modal analysis: identification of modes from response records, with the covariance of
// all results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signals/modal/stabilisation.hpp"

namespace wheeltap::signals {

struct ModalOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< band; highest_hz = 0: 0.45 of the sampling rate
  int largest_order = 0;                     ///< largest model order; 0: 10 per channel, limited to
                                             ///< 20 … 80
  int lags = 0;    ///< number of lags p + q; 0: enough for the model orders and a period of the
                   ///< lowest mode
  int blocks = 0;  ///< number of data blocks n_b; 0: 50, or fewer if the blocks would be too short
  std::vector<int> references = {};  ///< reference channels; empty: all channels
  /// Poles chosen by the user in the stabilisation diagram; empty: automatic selection.
  std::vector<ChosenPole> poles = {};
  int threads = 0;
};

/// Reasons to doubt a mode.
enum class ModeDoubt {
  few_orders,       ///< identified in fewer than half of the model orders from the first model
                    ///< order with the mode
  damping_unknown,  ///< standard deviation of the damping ratio exceeds half the damping ratio
  complex_shape,    ///< phase collinearity below 0.8
  tone,             ///< very low damping ratio and constant amplitude: perhaps a machine harmonic
  /// A second mode has the same shape. Either both frequencies
  /// are equal within the standard deviations, or the second
  /// mode lies within the half-power bandwidths and has a
  /// smaller uncertainty than this mode.
  twin,
  at_the_edge  ///< distance to an end of the band is below a twentieth of the bandwidth and of this
               ///< end
};

/// Modal phase collinearity below which a mode shape is doubtful.
inline constexpr double kCollinear = 0.8;

struct Mode {
  Pole pole = {};
  double collinearity = 0.0;        ///< modal phase collinearity
  double phase_deviation = 0.0;     ///< mean phase deviation [rad]
  int present = 0, orders = 0;      ///< number of model orders with this mode; number of all orders
                                    ///< from the first one
  double amplitude_kurtosis = 0.0;  ///< E|z|⁴ / (E|z|²)² of the amplitude near the frequency:
                                    ///< 1: sine, 2: noise
  Eigen::MatrixXd shape_covariance = {};  ///< covariance of real parts, then imaginary parts
  std::vector<ModeDoubt> doubts = {};
};

/// Identification method.
enum class ModalMethod {
  subspace,       ///< from output covariances (stochastic_subspace.hpp)
  polyreference,  ///< from frequency response functions (polyreference.hpp)
  realisation,    ///< from free decays (free_decay.hpp)
  decomposition,  ///< peaks of spectra (frequency_domain_decomposition.hpp)
  enhanced,       ///< decay of the correlation functions, computed from the spectra
  bayesian        ///< Bayesian inference in frequency bands
                  ///< (identification/modal/bayesian_modes.hpp)
};

/// Warnings about the whole identification.
struct ModalRemarks {
  bool short_blocks = false;  ///< fewer than 20 blocks, or blocks shorter than five times the lags
  int longer_decays = 0;      ///< number of modes whose decay time 1 / (ζω) exceeds the block
                              ///< length
  bool band_cut = false;      ///< the requested band exceeds the frequency range of the records
  int order_cut = 0;          ///< requested largest model order, if the records allow only a
                              ///< smaller model order
  int narrow = 0;             ///< number of modes whose half-power bandwidth is below the spacing
                              ///< of spectral lines
  int moved = 0;              ///< number of modes whose refined pole is far from the pole chosen in
                              ///< the diagram
  std::vector<std::string> unsettled = {};  ///< frequency bands with unreliable posterior draws,
                                            ///< each with the reason
};

struct ModalResult {
  ModalMethod method = ModalMethod::subspace;
  std::vector<Mode> modes = {};     ///< modes by ascending frequency
  Eigen::MatrixXd covariance = {};  ///< covariance of all frequencies [Hz], then all damping ratios
  Stabilisation diagram = {};
  bool chosen_by_hand = false;  ///< true: the modes are the poles that the user chose
  Eigen::VectorXd singular_values = {};
  double sample_rate_hz = 0.0;  ///< after decimation
  double lowest_hz = 0.0, highest_hz = 0.0;
  int decimated = 1, lags = 0, blocks = 0, largest_order = 0;
  double block_seconds = 0.0;
  int set_ups = 1;     ///< number of set-ups merged before identification
  long lines = 0;      ///< number of spectral lines of the frequency response functions
  int replicates = 0;  ///< number of bootstrap replicates, or of surrogate noise records
  std::vector<int> references = {};
  Eigen::MatrixXd singular_spectrum = {};  ///< for peaks of spectra, one row per line: frequency
                                           ///< [Hz], first singular value
  int segments = 0, segment = 0;           ///< number of segments of these spectra; samples per
                                           ///< segment
  ModalRemarks remarks = {};

  /// Number of blocks, replicates or surrogates from which the covariances are estimated; 0: the
  /// covariances are not estimated from a sample.
  [[nodiscard]] int covariance_samples() const { return blocks > 0 ? blocks : replicates; }
};

/// Identifies modes from `records`, with one channel per row. This function decimates the records
/// to a sampling rate that suffices for the band, and identifies the modes twice. In the first
/// identification, the lags cover one period of the lowest frequency of the band. In the second
/// identification, the lags cover one period of the lowest mode, because more lags increase the
/// variance of the estimates. Poles chosen by the user replace the modes selected from the last
/// diagram, but do not change the diagram. Throws ChosenPoleError. Throws ChannelError
/// (signals/refuse.hpp) for channels that are constant, proportional to another channel or not
/// finite. Throws std::invalid_argument for an invalid band and for records too short for any model
/// order.
[[nodiscard]] ModalResult identify_modes(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                         const ModalOptions& options);

/// Identifies modes from several set-ups, whose covariances are merged before identification
/// (merged_subspace.hpp). `sensors` gives the sensor number of each channel of each record, out of
/// `count` sensors. For each record, `references` gives the channels of the common reference
/// sensors, in the same order. The number of references limits the model orders; options.references
/// is not used. Throws std::invalid_argument like identify_modes.
[[nodiscard]] ModalResult identify_set_ups(const std::vector<Eigen::MatrixXd>& records,
                                           const std::vector<std::vector<int>>& sensors,
                                           const std::vector<std::vector<int>>& references,
                                           int count, const ModalOptions& options);

/// Checks and completes the band in `out`, and returns the records decimated for this band. Throws
/// std::invalid_argument like identify_modes. Public for the implementations of the methods.
[[nodiscard]] Eigen::MatrixXd records_of_band(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                              double sample_rate_hz, int threads, ModalResult& out);

/// Sets the member `doubts` of each mode. Public for the implementations of the methods.
void doubt_modes(ModalResult& result);

/// Computes the kurtosis E|z|⁴ / (E|z|²)² of the complex amplitude z of a signal near a frequency.
/// E is the mean over time windows of `cycles` cycles. The kurtosis is 1 for a steady sine and 2
/// for normal noise.
[[nodiscard]] double amplitude_kurtosis(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        double frequency_hz, double sample_rate_hz,
                                        double cycles = 20.0);

}  // namespace wheeltap::signals
