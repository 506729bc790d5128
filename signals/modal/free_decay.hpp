// Modes from free decays: the eigensystem realisation algorithm, with the covariance of all
// results.
//
// After an impact or a release, the response is y(k Δt) = C A^k x₀. The response samples replace
// the output covariances of stochastic_subspace.hpp. Each decay has its own initial state x₀ and
// serves as a reference channel (Juang & Pappa 1985, J. Guid. Control Dyn. 8:620).
//
// In the stabilisation diagram, poles that fit noise can be as stable as poles of vibration modes.
// A pole is therefore removed if the model without this pole fits the decays equally well. The
// remaining poles are refined together by a least-squares fit of
//
//   y(t) = Re Σ c e^{λt} + c₀
//
// over all channels and decays (variable projection). The uncertainty is computed for normal noise
// with the spectra and cross-spectra of the residuals, smoothed over spectral lines. The
// derivatives of the least-squares fit then give the covariance of the results.
#pragma once

#include <cstdint>
#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// Identifies modes from free decays. `decays` holds one matrix per decay, with one channel per
/// row. Each decay must begin after the end of the last force. All decays are cut to the length of
/// the shortest decay. ModalOptions::blocks is the number of surrogate noise records (0: 200).
/// ModalOptions::lags is the number of samples of each decay that are used (0: the largest possible
/// number). ModalOptions::references is not used. Throws std::invalid_argument for an invalid band,
/// decays with different numbers of channels, channels that are constant or not finite, and decays
/// too short for any order.
[[nodiscard]] ModalResult identify_decays(const std::vector<Eigen::MatrixXd>& decays,
                                          const ModalOptions& options, std::uint64_t seed = 1);

}  // namespace wheeltap::signals
