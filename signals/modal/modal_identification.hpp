// Operational modal analysis: modes from response records, with the covariance of all results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signals/modal/stabilisation.hpp"

namespace wheeltap::signals {

struct ModalOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: up to 0.45 of the rate
  int largest_order = 0;                     ///< 0: 10 per channel, from 20 to 80
  int lags = 0;    ///< p + q; 0: enough for the orders and a period of the lowest mode
  int blocks = 0;  ///< n_b; 0: 50, fewer if the blocks would be too short
  std::vector<int> references = {};  ///< channels; all if empty
  /// The modes: these poles of the diagram; chosen automatically if empty.
  std::vector<ChosenPole> poles = {};
  int threads = 0;
};

/// Reasons to doubt a mode.
enum class ModeDoubt {
  few_orders,       ///< in less than half of the orders after its first appearance
  damping_unknown,  ///< its standard deviation exceeds half its value
  complex_shape,    ///< phase collinearity below 0.8
  tone,             ///< very low damping and a constant amplitude: harmonic of a machine
  /// Another mode with the same shape is within both standard deviations, or within their
  /// half-power widths and known better.
  twin,
  at_the_edge  ///< within a twentieth of the band from one of its ends
};

/// Phase collinearity below which a shape is doubtful.
inline constexpr double kCollinear = 0.8;

struct Mode {
  Pole pole = {};
  double collinearity = 0.0;     ///< modal phase collinearity
  double phase_deviation = 0.0;  ///< mean phase deviation [rad]
  int present = 0, orders = 0;   ///< orders with this mode, and orders since its first appearance
  double amplitude_kurtosis = 0.0;  ///< E|z|⁴ / (E|z|²)² about its frequency: 1 a sine, 2 noise
  Eigen::MatrixXd shape_covariance = {};  ///< of real parts, then imaginary parts
  std::vector<ModeDoubt> doubts = {};
};

/// Identification method.
enum class ModalMethod {
  subspace,       ///< from output covariances (stochastic_subspace.hpp)
  polyreference,  ///< from frequency responses (polyreference.hpp)
  realisation,    ///< from free decays (free_decay.hpp)
  decomposition,  ///< peaks of spectra (frequency_domain_decomposition.hpp)
  enhanced,       ///< decays of these spectra
  bayesian        ///< of frequency bands, by sampling (identification/modal/bayesian_modes.hpp)
};

/// Warnings about the whole record.
struct ModalRemarks {
  bool short_blocks = false;  ///< fewer than 20 blocks, or less than five times the lags
  int longer_decays = 0;      ///< number of modes whose 1 / (ζω) exceeds a block
  bool band_cut = false;      ///< band exceeds the range of the sampling rate
  int order_cut = 0;          ///< requested largest order, if the records allow less
  int narrow = 0;             ///< number of modes with a half-power width below the line spacing
  int moved = 0;              ///< number of modes that refinement moved away
  std::vector<std::string> unsettled = {};  ///< bands with unreliable draws, with the reason
};

struct ModalResult {
  ModalMethod method = ModalMethod::subspace;
  std::vector<Mode> modes = {};     ///< by frequency
  Eigen::MatrixXd covariance = {};  ///< all frequencies [Hz], then all damping ratios
  Stabilisation diagram = {};
  bool chosen_by_hand = false;  ///< the modes are poles that the options list
  Eigen::VectorXd singular_values = {};
  double sample_rate_hz = 0.0;  ///< after decimation
  double lowest_hz = 0.0, highest_hz = 0.0;
  int decimated = 1, lags = 0, blocks = 0, largest_order = 0;
  double block_seconds = 0.0;
  int set_ups = 1;     ///< number of set-ups merged before identification
  long lines = 0;      ///< number of lines of the frequency responses
  int replicates = 0;  ///< bootstrap replicates, or surrogates of the noise
  std::vector<int> references = {};
  Eigen::MatrixXd singular_spectrum =
      {};                         ///< for peaks of spectra: line [Hz], first singular value
  int segments = 0, segment = 0;  ///< segments of these spectra: number, samples per segment
  ModalRemarks remarks = {};
};

/// Identifies modes from `records`, one channel per row. It decimates the records to the band and
/// identifies twice: first with the lags of one period of the band's lowest frequency, then with
/// those of one period of the lowest mode, since more lags add scatter. Poles chosen by hand
/// replace the modes of the last diagram; they do not change the diagram. Throws ChannelError
/// (signals/refuse.hpp) for channels that are constant, alike or not finite, ChosenPoleError, and
/// std::invalid_argument for an invalid band and for records too short for any order.
[[nodiscard]] ModalResult identify_modes(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                         const ModalOptions& options);

/// Modes from several set-ups, merged before identification (merged_subspace.hpp). `sensors` gives,
/// for each channel of a record, its number among `count` sensors. `references` gives the channels
/// of the common reference sensors, in the same order. The references limit the orders;
/// options.references is not used. Throws std::invalid_argument like identify_modes.
[[nodiscard]] ModalResult identify_set_ups(const std::vector<Eigen::MatrixXd>& records,
                                           const std::vector<std::vector<int>>& sensors,
                                           const std::vector<std::vector<int>>& references,
                                           int count, const ModalOptions& options);

/// The records decimated to the band of `out`, which it checks and fills in. Throws
/// std::invalid_argument like identify_modes. Public for the methods.
[[nodiscard]] Eigen::MatrixXd records_of_band(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                              double sample_rate_hz, int threads, ModalResult& out);

/// Sets the doubts of the modes. Public for the methods.
void doubt_modes(ModalResult& result);

/// Kurtosis E|z|⁴ / (E|z|²)² of a signal's complex amplitude near a frequency, averaged over
/// windows of `cycles` cycles: 1 for a steady sine, 2 for normal noise.
[[nodiscard]] double amplitude_kurtosis(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        double frequency_hz, double sample_rate_hz,
                                        double cycles = 20.0);

}  // namespace wheeltap::signals
