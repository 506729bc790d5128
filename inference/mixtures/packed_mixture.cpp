#include "inference/mixtures/packed_mixture.hpp"

#include <Eigen/Core>
#include <cmath>

#include "base/constants.hpp"
#include "base/log_gamma.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference::packed {

std::vector<const Routines*> runnable_routines(base::Instructions instructions) {
  base::Compiled<Routines> compiled{.baseline = &kBaselineRoutines};
#ifdef WHEELTAP_X86_KERNELS
  compiled.avx2 = &kAvx2Routines;
  compiled.avx512 = &kAvx512Routines;
#endif
  return base::runnable(compiled, instructions);
}

const Routines& routines() {
  static const Routines chosen = *runnable_routines(base::Instructions::automatic).back();
  return chosen;
}

double log_sum_diagonal(const Eigen::MatrixXd& factor) {
  return factor.diagonal().array().log().sum();
}

std::vector<double> pack(const std::vector<NormalMixture::Component>& components, double nu) {
  const auto d = components.front().mean.size();
  const auto dimension = static_cast<std::size_t>(d);
  const std::size_t stride = group_stride(dimension);
  const auto half = 0.5 * static_cast<double>(d);
  const double normaliser = std::isinf(nu)
                                ? -2.0 * half * kLogSqrt2Pi
                                : base::log_gamma(0.5 * nu + half) - base::log_gamma(0.5 * nu) -
                                      half * std::log(nu * M_PI);
  std::vector<double> packed(groups_of(components.size()) * stride, 0.0);
  for (std::size_t k = 0; k < groups_of(components.size()) * kLanes; ++k) {
    double* p = packed.data() + (k / kLanes) * stride + k % kLanes;
    if (k >= components.size()) {
      *p = -kInfinity;  // density 0 in a lane without a component
      continue;
    }
    const auto& c = components[k];
    *p = std::log(c.weight) + normaliser - log_sum_diagonal(c.factor);
    const Eigen::MatrixXd inverse =
        c.factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(d, d));
    const Eigen::VectorXd b = inverse * c.mean;
    for (Eigen::Index i = 0; i < d; ++i) {
      *(p += kLanes) = b[i];
      for (Eigen::Index j = 0; j <= i; ++j) *(p += kLanes) = inverse(i, j);
    }
  }
  return packed;
}

}  // namespace wheeltap::inference::packed
