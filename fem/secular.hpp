// The secular function of a few defects, for eight values of λ at a time. Internal to the
// reanalysis.
#pragma once

#include <cstddef>

namespace wheeltap::fem::detail {

// The kernels read plain arrays. This header must not include library code: in a file compiled for
// AVX-512 the linker could select its instance for every processor.

inline constexpr int kLanes = 8;      ///< values of λ evaluated together
inline constexpr int kPairChunk = 5;  ///< entries of F accumulated together

struct alignas(64) Pack {
  double lane[kLanes];
};

/// One set of defects in the coordinates of the intact modes. The static part of each mode is
/// subtracted, so that support columns can include rigid-body modes:
///
///   S(λ) = J - Σ_j κ_j e_j e_jᵀ,   κ_j = s_j / (λ_j - λ) - 1,   e_j = c_j / √s_j,
///
/// m × m. With s_j = λ_j, κ_j = λ / (λ_j - λ) tends to 0 with λ, and there is no cancellation if a
/// damage leaves almost no stiffness. For rigid-body modes s_j is the lowest elastic eigenvalue. J
/// = S at κ = 0 is -1 for supports, which come first, and 1 for damages; `DefectColumns` scales the
/// columns c accordingly. The modes far above the wanted range, j >= `near`, enter through a
/// Chebyshev series of κ / λ in λ over [0, cap], exact to rounding.
struct Secular {
  int columns = 0;   ///< m
  int supports = 0;  ///< number of support columns, which come first
  int near = 0;      ///< modes summed explicitly
  int negative = 0;  ///< number of leading modes with negative sign
  /// 1/θ, where |v|² >= θ Σ v_j² over the modes with positive sign; 1 if `negative` is 0.
  double residual_factor = 1.0;
  int terms = 0;                        ///< number of terms of the Chebyshev series
  double cap = 0.0;                     ///< largest λ that can be evaluated
  const double* eigenvalues = nullptr;  ///< λ_j of all modes
  const double* scales = nullptr;       ///< s_j of all modes
  std::size_t stride = 0;               ///< distance between columns of c
  const double* c = nullptr;            ///< c[a * stride + j]
  /// The entry (a, b <= a) number t of e eᵀ, row j (a near mode, then a term of the series), is
  /// pairs[((t / kPairChunk) * rows() + j) * kPairChunk + t % kPairChunk].
  const double* pairs = nullptr;

  [[nodiscard]] int rows() const { return near + terms; }
  [[nodiscard]] int chunks() const {
    return (columns * (columns + 1) / 2 + kPairChunk - 1) / kPairChunk;
  }
};

/// Without modes p and p + 1 (`lower_pole`), the rest A(λ) of S has no pole near λ, and the damaged
/// modes solve H(λ) v = 0,
///
///   H(λ) = diag(1/κ_p, 1/κ_{p+1}) - [e_p e_{p+1}]ᵀ A⁻¹ [e_p e_{p+1}],   N = -H' positive definite.
///
/// Each v of H v = δ N v, with η = A⁻¹ [e_p e_{p+1}] v, gives a shape φ = Σ_j a_j φ_j,
///
///   a_j = c_jᵀ η / (λ_j - λ), j ≠ p, p + 1,   a_p = (√s_p / (s_p - λ_p + λ)) v_p - (H v)_p / √s_p,
///
/// which satisfies the damaged problem apart from the residual g_p = (s_p - λ_p + λ) (H v)_p / √s_p
/// on those two modes (1/θ is `residual_factor`). Its Rayleigh quotient is λ + aᵀ g / |a|², correct
/// to second order, and an eigenvalue lies within r of it, r² = |g|² / (θ |a|²) - (aᵀ g / |a|²)²
/// (Parlett 1998, theorem 4.5.1).
struct SecularSteps {
  Pack negative;                        ///< negative inertia of A
  Pack smallest_pivot;                  ///< of A's factors, relative to the diagonal
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
  Pack* slope_matrix = nullptr;  ///< as `matrix`: -A' of the series
  Pack* forward = nullptr;       ///< 2 m
  Pack* forces = nullptr;        ///< 2 m, also a result: A⁻¹ e_p, then A⁻¹ e_{p+1}
};

/// The time-critical loops, compiled for one instruction set. Results are bitwise equal for all
/// instruction sets.
struct SecularKernel {
  const char* name;

  /// Evaluates at `lambda`, where `lower_pole` and the next mode are the nearest modes.
  void (*evaluate)(const Secular& secular, const Pack& lambda, const int (&lower_pole)[kLanes],
                   const SecularScratch& scratch, SecularSteps& steps);

  /// Fills `pairs` from c: products of the near modes, and the series of the far modes, near <= j <
  /// modes. series[p * (modes - near) + j] is the weight of mode near + j in term p and is
  /// negligible from series_end[p] on. `product` has space for the far modes.
  void (*fill_pairs)(const Secular& secular, int modes, const double* series, const int* series_end,
                     double* product, double* pairs);

  /// out[j] = c_jᵀ η / (λ_j - λ), j < modes: the components along all intact modes of the mode with
  /// forces η. The caller computes those of the two modes from `pole` on.
  void (*coordinates)(const Secular& secular, int modes, const double* eta, double lambda, int pole,
                      double* out);

  /// to[j] -= factor from[j], j < size.
  void (*subtract)(double* to, const double* from, double factor, int size);

  /// Σ_j a[j] b[j] w[j], j < size.
  double (*weighted_dot)(const double* a, const double* b, const double* w, int size);

  /// out[r] = Σ_j rows[r * stride + j] x[j], j < size.
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
