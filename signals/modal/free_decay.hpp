// Modes from free decays: the eigensystem realisation algorithm, with the covariance of all
// results.
//
// After an impact or a release, y(k Δt) = C A^k x₀. The samples replace the output covariances of
// stochastic_subspace.hpp, and each decay, with its own x₀, replaces a reference (Juang & Pappa
// 1985, J. Guid. Control Dyn. 8:620).
//
// Poles that fit noise can be as stable over orders as modes. A pole is therefore removed if the
// decays are fitted equally well without it. The remaining poles are refined together by least
// squares of
//
//   y(t) = Re Σ c e^{λt} + c₀
//
// over all channels and decays (variable projection). The uncertainty follows from normal noise
// with the spectra and cross-spectra of the residuals, smoothed over frequency lines. The
// derivatives of the least-squares fit propagate it.
#pragma once

#include <cstdint>
#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// `decays`: one matrix per decay, with one channel per row. Each decay begins after the last force
/// has ended; all are cut to the length of the shortest. ModalOptions::blocks is the number of
/// surrogates (0: 200), `lags` the number of samples used (0: as many as fit); `references` is not
/// used. Throws std::invalid_argument for an invalid band, channels that differ in number, are not
/// finite or constant, and decays too short for any order.
[[nodiscard]] ModalResult identify_decays(const std::vector<Eigen::MatrixXd>& decays,
                                          const ModalOptions& options, std::uint64_t seed = 1);

}  // namespace wheeltap::signals
