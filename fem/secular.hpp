// Evaluation of the secular function of a few defects for eight values of λ at a time. Internal to
// the reanalysis.
#pragma once

#include <cstddef>

namespace wheeltap::fem::detail {

// The kernels read plain arrays. This header must not include library code: the linker could select
// a library function with AVX-512 instructions for every processor.

inline constexpr int kLanes = 8;      ///< number of values of λ that are evaluated together
inline constexpr int kPairChunk = 5;  ///< number of entries of e eᵀ that are summed together

struct alignas(64) Pack {
  double lane[kLanes];
};

/// The secular function of one set of defects, in intact modal coordinates. The static term of each
/// mode is subtracted, so that the columns of supports can include rigid-body modes:
///
///   S(λ) = J - Σ_j κ_j e_j e_jᵀ,   κ_j = s_j / (λ_j - λ) - 1,   e_j = c_j / √s_j,
///
/// where S has the size m × m. For s_j = λ_j, κ_j = λ / (λ_j - λ), so that κ_j tends to 0 as λ
/// tends to 0. The sum is then free of cancellation, even if a damage leaves almost no stiffness.
/// For rigid-body modes, s_j is the lowest elastic eigenvalue. J, the value of S at κ = 0, is
/// diagonal: -1 for supports, which come first, and 1 for damaged elements. `DefectColumns` scales
/// the columns c accordingly. The modes far above the requested range, j >= `near`, are represented
/// by a Chebyshev series of κ / λ in λ over [0, cap], accurate to rounding.
struct Secular {
  int columns = 0;   ///< m
  int supports = 0;  ///< number of support columns, which come first
  int near = 0;      ///< number of modes summed explicitly
  int negative = 0;  ///< number of leading modes with negative sign
  /// 1/θ. Every displacement vector v satisfies |v|² >= θ Σ v_j², with the sum over the modes with
  /// positive sign. The value is 1 if `negative` is 0.
  double residual_factor = 1.0;
  int terms = 0;                        ///< number of terms of the Chebyshev series
  double cap = 0.0;                     ///< largest λ that can be evaluated
  const double* eigenvalues = nullptr;  ///< λ_j of all modes
  const double* scales = nullptr;       ///< s_j of all modes
  std::size_t stride = 0;               ///< distance between columns of c
  const double* c = nullptr;            ///< c[a * stride + j]
  /// The entries of e eᵀ. Entry (a, b <= a) has the index t; each row j belongs to a near mode, or
  /// to a term of the series. The array element is pairs[((t / kPairChunk) * rows() + j) *
  /// kPairChunk + t % kPairChunk].
  const double* pairs = nullptr;

  [[nodiscard]] int rows() const { return near + terms; }
  [[nodiscard]] int chunks() const {
    return (columns * (columns + 1) / 2 + kPairChunk - 1) / kPairChunk;
  }
};

/// Results of one evaluation of S. The part A(λ) of S without the modes p and p + 1 (`lower_pole`)
/// has no pole near λ. The modes of the damaged structure solve H(λ) v = 0,
///
///   H(λ) = diag(1/κ_p, 1/κ_{p+1}) - [e_p e_{p+1}]ᵀ A⁻¹ [e_p e_{p+1}],   N = -H' positive definite.
///
/// Each solution v of H v = δ N v, with η = A⁻¹ [e_p e_{p+1}] v, gives a mode shape φ = Σ_j a_j
/// φ_j,
///
///   a_j = c_jᵀ η / (λ_j - λ), j ≠ p, p + 1,   a_p = (√s_p / (s_p - λ_p + λ)) v_p - (H v)_p / √s_p,
///
/// This shape satisfies the eigenvalue problem of the damaged structure apart from the residual g_p
/// = (s_p - λ_p + λ) (H v)_p / √s_p on the two modes p and p + 1. The Rayleigh quotient of φ is λ +
/// aᵀ g / |a|², correct to second order. An eigenvalue lies within r of the Rayleigh quotient, r² =
/// |g|² / (θ |a|²) - (aᵀ g / |a|²)² (Parlett 1998, theorem 4.5.1; 1/θ: `residual_factor`).
struct SecularSteps {
  Pack negative;                        ///< negative inertia of A
  Pack smallest_pivot;                  ///< smallest pivot of the factorisation of A, divided by
                                        ///< the diagonal
  Pack low, high;                       ///< δ, low <= high
  Pack low_step, high_step;             ///< Rayleigh quotients - λ
  Pack low_residual, high_residual;     ///< r²
  Pack low_v1, low_v2, low_a1, low_a2;  ///< v and (a_p, a_{p+1}), |a| = 1
  Pack high_v1, high_v2, high_a1, high_a2;
};

/// Scratch memory of `evaluate`.
struct SecularScratch {
  Pack* weights = nullptr;       ///< rows(): κ_j, then λ T_p
  Pack* slopes = nullptr;        ///< rows(): 1/(λ_j - λ)², then (λ T_p)'
  Pack* matrix = nullptr;        ///< chunks() · kPairChunk: Σ κ e eᵀ, then A, then its factors
  Pack* slope_matrix = nullptr;  ///< -A' of the series, stored like `matrix`
  Pack* forward = nullptr;       ///< 2 m
  Pack* forces = nullptr;  ///< 2 m, also a result of `evaluate`: A⁻¹ e_p, then A⁻¹ e_{p+1}
};

/// The functions that take most of the run time, compiled for one instruction set. The results are
/// bitwise equal for all instruction sets.
struct SecularKernel {
  const char* name;

  /// Evaluates the secular function at `lambda`. In each lane, the modes `lower_pole` and
  /// `lower_pole` + 1 are the modes nearest to λ.
  void (*evaluate)(const Secular& secular, const Pack& lambda, const int (&lower_pole)[kLanes],
                   const SecularScratch& scratch, SecularSteps& steps);

  /// Computes `pairs` from the columns c: the products for the modes j < near, and the series for
  /// the modes near <= j < modes. The weight of mode near + j in term p is series[p * (modes -
  /// near) + j]; weights from j = series_end[p] on are negligible. `product` is scratch memory for
  /// the series.
  void (*fill_pairs)(const Secular& secular, int modes, const double* series, const int* series_end,
                     double* product, double* pairs);

  /// Computes out[j] = c_jᵀ η / (λ_j - λ), j < modes: the components of the mode with the forces η
  /// along all intact modes. The caller computes the components along the modes `pole` and `pole` +
  /// 1.
  void (*coordinates)(const Secular& secular, int modes, const double* eta, double lambda, int pole,
                      double* out);

  /// Subtracts factor · from[j] from to[j], j < size.
  void (*subtract)(double* to, const double* from, double factor, int size);

  /// Returns Σ_j a[j] b[j] w[j], j < size.
  double (*weighted_dot)(const double* a, const double* b, const double* w, int size);

  /// Computes out[r] = Σ_j rows[r * stride + j] x[j], j < size.
  void (*project)(const double* rows, int count, std::size_t stride, const double* x, int size,
                  double* out);
};

extern const SecularKernel kBaselineKernel;
#ifdef WHEELTAP_X86_KERNELS
extern const SecularKernel kAvx2Kernel;
extern const SecularKernel kAvx512Kernel;
#endif

/// The fastest kernel that this processor can run.
[[nodiscard]] const SecularKernel& secular_kernel();

/// All kernels that this processor can run, as a null-terminated list.
[[nodiscard]] const SecularKernel* const* secular_kernels();

}  // namespace wheeltap::fem::detail
