// Loops over normal mixtures packed for vector instructions (packed_mixture.hpp). The loops are
// compiled for several SIMD widths. This header uses only plain pointers and numbers, because the
// linker could use a library template compiled for another width (see base/simd.hpp).
#pragma once

#include <cstddef>

namespace wheeltap::inference::packed {

inline constexpr std::size_t kLanes = 8;
inline constexpr std::size_t kMaxComponents = 512;

/// Components are stored in groups of eight, so that one instruction processes several components.
/// A group of a packed mixture holds eight values (one per component) of each of:
///   c;  b_1, A_11;  b_2, A_21, A_22;  …
/// Component k has the log density c_k - ½ |A_k z - b_k|². Returns the number of doubles per group.
[[nodiscard]] constexpr std::size_t group_stride(std::size_t d) {
  return kLanes * (1 + d + d * (d + 1) / 2);
}
[[nodiscard]] constexpr std::size_t groups_of(std::size_t components) {
  return (components + kLanes - 1) / kLanes;
}

struct Samples {
  std::size_t n, d;
  const double* z;       ///< n × d, row-major
  const double* weight;  ///< n
};

/// Functions compiled for several instruction sets with bitwise equal results; selected once at run
/// time.
struct Routines {
  /// ln Σ_k exp(c_k - ½ |A_k z - b_k|²)
  double (*log_density)(const double* packed, std::size_t groups, std::size_t stride,
                        const double* z, std::size_t d);
  /// |A_k z - b_k|² of each mixture component k
  void (*quadratic_forms)(const double* packed, std::size_t groups, std::size_t stride,
                          const double* z, std::size_t d, double* values);
  /// One EM iteration over the samples. A group of `moments` has eight values of each sum:
  ///   Σ w r;  Σ r;  Σ w r e_1, Σ w r e_1 e_1;  Σ w r e_2, Σ w r e_2 e_1, Σ w r e_2 e_2;  …
  /// with responsibilities r and deviations e = z - μ from the *current* means, which avoid
  /// cancellation in the moments of a narrow component. Returns Σ w ln q.
  double (*em_pass)(const double* packed, const double* means, std::size_t groups,
                    std::size_t stride, const Samples& samples, double* moments);
};

extern const Routines kBaselineRoutines;
#ifdef WHEELTAP_X86_KERNELS
extern const Routines kAvx2Routines;
extern const Routines kAvx512Routines;
#endif

}  // namespace wheeltap::inference::packed
