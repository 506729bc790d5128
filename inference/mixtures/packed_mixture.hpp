// Normal mixtures packed for vector instructions, and their evaluation.
//
//   ln w_k N(z; μ_k, L_k L_kᵀ) = c_k - ½ |A_k z - b_k|²,   A = L⁻¹,   b = L⁻¹ μ.
#pragma once

#include <vector>

#include "base/simd.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/mixtures/packed_routines.hpp"

namespace wheeltap::inference::packed {

/// Packs components for vector instructions. The constants c are those of normal components if ν =
/// ∞, and those of components with Student's t distribution if ν is finite.
[[nodiscard]] std::vector<double> pack(const std::vector<NormalMixture::Component>& components,
                                       double nu);

[[nodiscard]] const Routines& routines();
/// The routines that this processor can run, sorted by SIMD width, the narrowest first.
[[nodiscard]] std::vector<const Routines*> runnable_routines(base::Instructions instructions);

/// ln |L|, the log determinant of a triangular factor.
[[nodiscard]] double log_sum_diagonal(const Eigen::MatrixXd& factor);

}  // namespace wheeltap::inference::packed
