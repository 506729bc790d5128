// The secular function of a few defects, for eight values of λ at once. Internal to the reanalysis.
#pragma once

#include <cstddef>

namespace wheeltap::fem::detail {

// The kernels read plain arrays: nothing here may pull library code into a file compiled for
// AVX-512, where the linker could pick its instance for every processor.

inline constexpr int kLanes = 8;      ///< values of λ evaluated together
inline constexpr int kPairChunk = 5;  ///< entries of F accumulated together

struct alignas(64) Pack {
  double lane[kLanes];
};

/// One set of defects, in the coordinates of the intact modes: F(λ) = Σ_j c_j c_jᵀ / (λ_j - λ), m ×
/// m. The modes far above the wanted range, j >= `near`, enter through a Chebyshev series in λ over
/// [0, cap], exact to rounding.
struct Secular {
  int columns = 0;                      ///< m
  int near = 0;                         ///< modes summed explicitly
  int terms = 0;                        ///< of the Chebyshev series
  double cap = 0.0;                     ///< largest λ that may be asked for
  const double* eigenvalues = nullptr;  ///< λ_j of all modes
  std::size_t stride = 0;               ///< between columns of c
  const double* c = nullptr;            ///< c[a * stride + j]
  const double* inverse_gamma =
      nullptr;  ///< diag Γ⁻¹: 1/r for damages, -1/k for supports, 0 if rigid
  /// Entry (a, b <= a) number t of c cᵀ, row j (a near mode, then a term of the series), is at
  /// pairs[((t / kPairChunk) * rows() + j) * kPairChunk + t % kPairChunk].
  const double* pairs = nullptr;

  [[nodiscard]] int rows() const { return near + terms; }
  [[nodiscard]] int chunks() const {
    return (columns * (columns + 1) / 2 + kPairChunk - 1) / kPairChunk;
  }
};

/// With modes p and p + 1 (`lower_pole`) left out of F, A(λ) = Γ⁻¹ - F(λ) has no pole near λ, and
/// the damaged modes solve H(λ) v = 0,
///
///   H(λ) = diag(λ_p - λ, λ_{p+1} - λ) - [c_p c_{p+1}]ᵀ A⁻¹ [c_p c_{p+1}],   N = -H' positive
///   definite.
///
/// det(H - d N) = 0 gives two steps d from λ to roots, right to second order.
struct SecularSteps {
  Pack low, high;  ///< the two steps, low <= high
  Pack negative;   ///< negative inertia of A
  Pack h11, h12, h22, n11, n12, n22;
};

/// Memory of `evaluate`.
struct SecularScratch {
  Pack* weights = nullptr;       ///< rows(): 1/(λ_j - λ), then T_p
  Pack* slopes = nullptr;        ///< rows(): their derivatives
  Pack* matrix = nullptr;        ///< chunks() · kPairChunk: F, then A, then its factors
  Pack* slope_matrix = nullptr;  ///< as `matrix`: F' of the series
  Pack* forward = nullptr;       ///< 2 m
  Pack* forces = nullptr;        ///< 2 m, a result too: A⁻¹ c_p, then A⁻¹ c_{p+1}
};

/// The loops that count, compiled for one instruction set. All sets give the same bits.
struct SecularKernel {
  const char* name;

  /// Evaluates at `lambda`, whose nearest modes are `lower_pole` and the next.
  void (*evaluate)(const Secular& secular, const Pack& lambda, const int (&lower_pole)[kLanes],
                   const SecularScratch& scratch, SecularSteps& steps);

  /// Fills `pairs` from c: products of the near modes, and the series of the far ones, near <= j <
  /// modes. series[p * (modes - near) + j] weighs mode near + j in term p and is negligible from
  /// series_end[p] on. `product` has room for the far modes.
  void (*fill_pairs)(const Secular& secular, int modes, const double* series, const int* series_end,
                     double* product, double* pairs);

  /// out[j] = c_jᵀ η / (λ_j - λ), j < modes: what the mode with forces η has of every intact mode;
  /// the two modes from `pole` on are left to the caller.
  void (*coordinates)(const Secular& secular, int modes, const double* eta, double lambda, int pole,
                      double* out);

  /// out[r] = Σ_j rows[r * stride + j] x[j], j < size.
  void (*project)(const double* rows, int count, std::size_t stride, const double* x, int size,
                  double* out);
};

extern const SecularKernel kBaselineKernel;
#ifdef WHEELTAP_X86_KERNELS
extern const SecularKernel kAvx2Kernel;
extern const SecularKernel kAvx512Kernel;
#endif

/// The fastest of the kernels that this processor runs.
[[nodiscard]] const SecularKernel& secular_kernel();

/// All that it runs, null-terminated.
[[nodiscard]] const SecularKernel* const* secular_kernels();

}  // namespace wheeltap::fem::detail
