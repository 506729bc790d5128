// A record of a structure in vibration, and its modes by any of the methods.
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

/// What is measured, and by which method modes are identified: the first of `responses` (pLSCF),
/// `bands` (Bayesian), `spectral` (FDD, EFDD) and `decays` (ERA) that is given, else SSI-cov.
struct ModalRecord {
  Eigen::MatrixXd records = {};  ///< a response channel a row; empty where responses were measured
  /// Orders of differentiation of the channels (0: displacements); empty where none is known.
  std::vector<int> orders = {};
  signals::ModalOptions options = {};
  std::optional<signals::FrequencyResponses> responses = {};
  std::vector<Eigen::MatrixXd> decays = {};  ///< pieces of the records
  std::vector<ModalBand> bands = {};
  std::optional<signals::ModalMethod> spectral = {};  ///< decomposition or enhanced
  int segment = 0;  ///< of FDD and EFDD, as signals::DecompositionOptions has it
};

/// Modes with shapes of one quantity (signals::convert_shapes). Throws signals::ChannelError for a
/// channel that the method cannot use, and std::invalid_argument as the methods do.
[[nodiscard]] signals::ModalResult identify(const ModalRecord& record, std::uint64_t seed);

/// What the record holds within the band of `result`: singular values where the method computed
/// them, else frequency responses, else spectra of the channels.
[[nodiscard]] std::vector<signals::SpectralLevel> spectral_levels(
    const ModalRecord& record, const signals::ModalResult& result);

}  // namespace wheeltap::identification
