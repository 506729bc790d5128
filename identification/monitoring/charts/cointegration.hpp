// Cointegration of features: a linear combination that is stationary although the features follow
// the weather.
//
// Johansen's procedure (1988) for a vector error correction model with a constant and one lagged
// difference: R0 and R1 are the residuals of Δy_t and y_t-1 after regression on (1, Δy_t-1), and
// S_ij = R_i' R_j/n. The result is the vector b with the largest λ in
//
//   S10 S00⁻¹ S01 b = λ S11 b.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

/// `levels` (n x p) has complete rows in order of time, n > 3 p + 3. The result b has b' S11 b = 1.
[[nodiscard]] Eigen::VectorXd cointegrating_vector(const Eigen::MatrixXd& levels);

}  // namespace wheeltap::identification::monitoring
