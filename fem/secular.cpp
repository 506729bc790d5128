#include "fem/secular.hpp"

#include <algorithm>

#include "base/simd.hpp"

namespace wheeltap::fem::detail {

const SecularKernel* const* secular_kernels() {
  static const std::vector<const SecularKernel*> kernels = [] {
    base::Compiled<SecularKernel> compiled{.baseline = &kBaselineKernel};
#ifdef WHEELTAP_X86_KERNELS
    compiled.avx2 = &kAvx2Kernel;
    compiled.avx512 = &kAvx512Kernel;
#endif
    std::vector<const SecularKernel*> found = base::runnable(compiled);
    std::reverse(found.begin(), found.end());
    found.push_back(nullptr);
    return found;
  }();
  return kernels.data();
}

const SecularKernel& secular_kernel() {
  return *secular_kernels()[0];
}

}  // namespace wheeltap::fem::detail
