#include "fem/secular.hpp"

namespace wheeltap::fem::detail {

const SecularKernel* const* secular_kernels() {
  static const struct Available {
    const SecularKernel* kernels[4] = {};
    Available() {
      int count = 0;
#ifdef WHEELTAP_X86_KERNELS
      if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
          __builtin_cpu_supports("avx512vl"))
        kernels[count++] = &kAvx512Kernel;
      if (__builtin_cpu_supports("avx2")) kernels[count++] = &kAvx2Kernel;
#endif
      kernels[count] = &kBaselineKernel;
    }
  } available;
  return available.kernels;
}

const SecularKernel& secular_kernel() {
  return *secular_kernels()[0];
}

}  // namespace wheeltap::fem::detail
