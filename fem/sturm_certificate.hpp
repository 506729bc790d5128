// Proof that no mode was missed.
#pragma once

#include "base/eigen.hpp"

#include "fem/assembly.hpp"

namespace wheeltap::fem {

/// True where the ascending `eigenvalues` contain every eigenvalue of the problem below some gap at
/// or above number `count`: K - σ M has, for σ in that gap, as many negative pivots as there are
/// given eigenvalues below σ. So give a few more than `count`; without any gap among those the
/// answer is false, unless all eigenvalues are given.
[[nodiscard]] bool nothing_missed(const Assembly<double>& assembly,
                                  const Eigen::Ref<const Eigen::VectorXd>& eigenvalues,
                                  Eigen::Index count);

}  // namespace wheeltap::fem
