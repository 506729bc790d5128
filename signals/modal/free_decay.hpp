// Modes from free decays: the eigensystem realisation algorithm, with the covariance of all it
// finds.
//
// After a knock or a release, y(k Δt) = C A^k x₀: the samples themselves stand where output
// covariances stand in stochastic_subspace.hpp, and each decay, with its own x₀, where a reference
// does (Juang & Pappa 1985, J. Guid. Control Dyn. 8:620).
//
// Poles that fit noise are as stable over orders as modes are: those without which the decays would
// be explained as well are left out. The rest are refined together, to the least squares of
//
//   y(t) = Re Σ c e^{λt} + c₀
//
// over all channels and decays (variable projection). Uncertainty: normal noise with the spectra
// and cross-spectra of what is left, smoothed over lines, through the derivatives of that fit.
#pragma once

#include <cstdint>
#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// `decays`: a channel a row, each begins when nothing drives the structure any more; the shortest
/// says how much is used. ModalOptions::blocks is the number of surrogates (0: 200), `lags` how
/// many samples are used (0: as many as there is room for), `references` is not used. Throws
/// std::invalid_argument for a band that is none, channels that differ in number or are not finite
/// or still throughout, and decays too short for any order.
[[nodiscard]] ModalResult identify_decays(const std::vector<Eigen::MatrixXd>& decays,
                                          const ModalOptions& options, std::uint64_t seed = 1);

}  // namespace wheeltap::signals
