// From records of a structure in operation to its modes, with the covariance of all that is said.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signals/modal/stabilisation.hpp"

namespace wheeltap::signals {

struct ModalOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: up to 0.45 of the rate
  int largest_order = 0;                     ///< 0: 10 a channel, from 20 to 80
  int lags = 0;    ///< p + q; 0: what orders need, and a period of the lowest mode
  int blocks = 0;  ///< n_b; 0: 50, fewer where they would be too short
  std::vector<int> references = {};  ///< channels; all if empty
  int threads = 0;
};

/// Why a mode is not to be trusted at once.
enum class ModeDoubt {
  few_orders,       ///< in less than half of the orders from its first on
  damping_unknown,  ///< its standard deviation is more than half of it
  complex_shape,    ///< phase collinearity below 0.8
  tone,             ///< hardly damped, and its amplitude does not fluctuate: a machine's
  /// Another mode is as near as both are uncertain, or within their half-power widths and known
  /// better, with the same shape.
  twin,
  at_the_edge  ///< within a twentieth of an end of the band
};

/// Phase collinearity below which a shape is doubtful.
inline constexpr double kCollinear = 0.8;

struct Mode {
  Pole pole = {};
  double collinearity = 0.0;        ///< modal phase collinearity
  double phase_deviation = 0.0;     ///< mean phase deviation [rad]
  int present = 0, orders = 0;      ///< of the diagram's orders since its first
  double amplitude_kurtosis = 0.0;  ///< E|z|⁴ / (E|z|²)² about its frequency: 1 a sine, 2 noise
  Eigen::MatrixXd shape_covariance = {};  ///< of real parts, then imaginary parts
  std::vector<ModeDoubt> doubts = {};
};

/// How modes were found.
enum class ModalMethod {
  subspace,       ///< from output covariances (stochastic_subspace.hpp)
  polyreference,  ///< from frequency responses (polyreference.hpp)
  realisation,    ///< from free decays (free_decay.hpp)
  decomposition,  ///< peaks of spectra (frequency_domain_decomposition.hpp)
  enhanced,       ///< and the decays that these hold
  bayesian        ///< of bands, by sampling (identification/modal/bayesian_modes.hpp)
};

/// What is odd about the whole record.
struct ModalRemarks {
  bool short_blocks = false;  ///< fewer than 20 blocks, or less than five times the lags
  int longer_decays = 0;      ///< modes whose 1 / (ζω) is longer than a block
  bool band_cut = false;      ///< band beyond what the sampling holds
  int order_cut = 0;          ///< largest order that was asked for, where records allow less
  int narrow = 0;             ///< modes of a half-power width below the spacing of lines
  int moved = 0;              ///< modes that their refinement took elsewhere
  std::vector<std::string> unsettled = {};  ///< bands whose draws are not to be relied on, and why
};

struct ModalResult {
  ModalMethod method = ModalMethod::subspace;
  std::vector<Mode> modes = {};     ///< by frequency
  Eigen::MatrixXd covariance = {};  ///< of all frequencies [Hz], then all damping ratios
  Stabilisation diagram = {};
  Eigen::VectorXd singular_values = {};
  double sample_rate_hz = 0.0;  ///< after decimation
  double lowest_hz = 0.0, highest_hz = 0.0;
  int decimated = 1, lags = 0, blocks = 0, largest_order = 0;
  double block_seconds = 0.0;
  int set_ups = 1;     ///< that were merged before they were identified
  long lines = 0;      ///< of frequency responses
  int replicates = 0;  ///< of the bootstrap, or surrogates of the noise
  std::vector<int> references = {};
  Eigen::MatrixXd singular_spectrum = {};  ///< of peaks of spectra: line [Hz], its first value
  int segments = 0, segment = 0;           ///< of these spectra: how many, of how many samples
  ModalRemarks remarks = {};
};

/// `records` holds a channel a row. Records are decimated to the band, and identified twice: first
/// with as many lags as a period of the band's lowest frequency takes, then with as many as one of
/// the lowest mode's takes; more lags add scatter. Throws ChannelError (signals/refuse.hpp) for
/// channels that are constant, alike or not finite, and std::invalid_argument for a band that is
/// none and for records too short for any order.
[[nodiscard]] ModalResult identify_modes(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                         const ModalOptions& options);

/// Modes of one structure from several set-ups, merged before they are identified
/// (merged_subspace.hpp): `sensors` says which of `count` sensors each channel of a record is,
/// `references` which of its channels are at those that all set-ups have, in one order. Orders are
/// limited by what the references can hold; options.references is not used. Throws
/// std::invalid_argument as identify_modes does.
[[nodiscard]] ModalResult identify_set_ups(const std::vector<Eigen::MatrixXd>& records,
                                           const std::vector<std::vector<int>>& sensors,
                                           const std::vector<std::vector<int>>& references,
                                           int count, const ModalOptions& options);

/// Records decimated to the band of `out`, which is checked and filled in. Throws
/// std::invalid_argument as identify_modes does. Exposed for the methods.
[[nodiscard]] Eigen::MatrixXd records_of_band(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                              double sample_rate_hz, int threads, ModalResult& out);

/// Fills in the modes' doubts. Exposed for the methods.
void doubt_modes(ModalResult& result);

/// E|z|⁴ / (E|z|²)² of a signal's complex amplitude about a frequency, averaged over windows of
/// `cycles` of it: 1 for a steady sine, 2 for normal noise.
[[nodiscard]] double amplitude_kurtosis(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        double frequency_hz, double sample_rate_hz,
                                        double cycles = 20.0);

}  // namespace wheeltap::signals
