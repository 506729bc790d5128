// Normal mixtures packed for vector instructions, and their evaluation.
//
//   ln w_k N(z; μ_k, L_k L_kᵀ) = c_k - ½ |A_k z - b_k|²,   A = L⁻¹,   b = L⁻¹ μ.
#pragma once

#include <vector>

#include "base/simd.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/mixtures/packed_routines.hpp"

namespace wheeltap::inference::packed {

/// Packs components; ν = ∞: normal, otherwise c is that of Student's t.
[[nodiscard]] std::vector<double> pack(const std::vector<NormalMixture::Component>& components,
                                       double nu);

[[nodiscard]] const Routines& routines();
/// The routines that this processor can run, the narrowest vectors first.
[[nodiscard]] std::vector<const Routines*> runnable_routines(base::Instructions instructions);

/// ln |L|
[[nodiscard]] double log_sum_diagonal(const Eigen::MatrixXd& factor);

}  // namespace wheeltap::inference::packed
