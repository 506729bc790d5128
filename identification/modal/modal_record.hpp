// A vibration record of a structure, and identification of its modes by one of several methods.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/eigen.hpp"
#include "identification/modal/bayesian_modes.hpp"
#include "signals/frequency_responses.hpp"
#include "signals/modal/modal_identification.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::identification {

/// Measured data and the identification method. The first member that is set determines the method:
/// `responses` (pLSCF), `bands` (Bayesian), `spectral` (FDD, EFDD), `decays` (ERA). If none is set,
/// the method is SSI-cov.
struct ModalRecord {
  /// One response channel per row; empty if frequency response functions were measured
  Eigen::MatrixXd records = {};
  /// Orders of differentiation of the channels (0: displacement); empty if unknown.
  std::vector<int> orders = {};
  signals::ModalOptions options = {};
  std::optional<signals::FrequencyResponses> responses = {};
  /// free decays (segments of the records)
  std::vector<Eigen::MatrixXd> decays = {};
  std::vector<ModalBand> bands = {};
  std::optional<signals::ModalMethod> spectral = {};  ///< FDD (decomposition) or EFDD (enhanced)
  int segment = 0;  ///< segment length for FDD and EFDD, as in signals::DecompositionOptions
};

/// Identifies modes. All entries of a shape have the same quantity, e.g. displacement
/// (signals::convert_shapes). Throws signals::ChannelError for a channel that the method cannot
/// use, and std::invalid_argument as described for each method.
[[nodiscard]] signals::ModalResult identify(const ModalRecord& record, std::uint64_t seed);

/// The spectrum to plot within the band of `result`. The first available spectrum is used: singular
/// values, frequency response functions, spectra of the channels.
[[nodiscard]] std::vector<signals::SpectralLevel> spectral_levels(
    const ModalRecord& record, const signals::ModalResult& result);

}  // namespace wheeltap::identification
