#include "fem/sturm_certificate.hpp"

#include "fem/skyline_ldlt.hpp"

namespace wheeltap::fem {

bool nothing_missed(const Assembly<double>& assembly,
                    const Eigen::Ref<const Eigen::VectorXd>& eigenvalues, Eigen::Index count) {
  constexpr double kClearGap = 1e-6;  // relative; rounding of the factorisation cannot close it
  if (eigenvalues.size() == assembly.stiffness.rows()) return true;
  for (Eigen::Index below = count; below < eigenvalues.size(); ++below) {
    const double low = eigenvalues[below - 1], high = eigenvalues[below];
    if (high - low <= kClearGap * high) continue;
    SkylineLdlt<double> ldlt(assembly.stiffness, assembly.mass);
    for (const double place : {0.5, 0.45, 0.55, 0.4, 0.6}) {
      const int negative = ldlt.factor(low + place * (high - low));
      if (ldlt.stable()) return negative == below;
    }
    return false;
  }
  return false;
}

}  // namespace wheeltap::fem
