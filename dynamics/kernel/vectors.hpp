// Vectors of parameter sets, one per lane. Part of kernel_impl.hpp, which describes the
// compilation.
#pragma once

#include "base/lanes.hpp"
#include "dynamics/kernel.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

namespace lanes = base::lanes;

using V __attribute__((vector_size(8 * WHEELTAP_LANES))) = double;

#define WHEELTAP_INLINE [[gnu::always_inline]] inline
#define WHEELTAP_UNROLL _Pragma("GCC unroll 8")

WHEELTAP_INLINE const V* vectors(const double* p) {
  return reinterpret_cast<const V*>(p);
}
WHEELTAP_INLINE V* vectors(double* p) {
  return reinterpret_cast<V*>(p);
}

WHEELTAP_INLINE bool all(V mask) {
  for (int lane = 0; lane < WHEELTAP_LANES; ++lane)
    if (mask[lane] == 0.0) return false;
  return true;
}

WHEELTAP_INLINE bool any(V mask) {
  for (int lane = 0; lane < WHEELTAP_LANES; ++lane)
    if (mask[lane] != 0.0) return true;
  return false;
}

/// Returns 1 in every lane in which |x| exceeds the bound or x is NaN, else 0.
WHEELTAP_INLINE V outside(V x, double bound) {
  return lanes::abs(x) <= bound ? V{} : V{} + 1.0;
}

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
