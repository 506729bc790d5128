// The loop that computes the evidence in training (marginal_likelihood.hpp) for several features at
// once, one feature in each SIMD lane.
//
// The loop is compiled for several SIMD widths, so this header must not include library code
// (base/simd.hpp). No result depends on the width.
#pragma once

namespace wheeltap::identification::monitoring::detail {

inline constexpr int kLanes = 8;
/// Largest number of columns: one per term and one for the feature.
inline constexpr int kMostColumns = 24;

/// Input for a group of kLanes features: n rows and K terms. Missing entries have the variance 0.
struct EvidenceRows {
  int rows, terms;
  const double* table;       ///< phi of each row (n x K)
  const double* values;      ///< n x kLanes
  const double* variance;    ///< noise variances with σ = 1 (n x kLanes)
  const double* fast_decay;  ///< decay of the fast drift since the previous row (n rows)
  const double* slow_decay;  ///< decay of the slow drift since the previous row (n rows)
  const double* fast_ratio;  ///< kLanes
  double slow_ratio;
};

struct EvidenceSums {
  double* gram;        ///< (K + 1)(K + 2)/2 x kLanes: lower part of Σ w wᵀ, w whitened [phi, y]
  double* log_scales;  ///< kLanes: Σ ln of the innovations' variances
};

struct EvidenceKernel {
  const char* name;
  /// Computes the sums over all rows for the first `features` lanes.
  void (*accumulate)(const EvidenceRows& rows, int features, const EvidenceSums& sums);
};

extern const EvidenceKernel kBaselineEvidence;
#ifdef WHEELTAP_X86_KERNELS
extern const EvidenceKernel kAvx2Evidence;
extern const EvidenceKernel kAvx512Evidence;
#endif

}  // namespace wheeltap::identification::monitoring::detail
