// The secular function of a few defects, for eight values of λ at once.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace wheeltap::fem::detail {

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
  const double* eigenvalues = nullptr;  ///< λ_j, at least `near`
  std::size_t stride = 0;               ///< between columns of c
  const double* c = nullptr;            ///< c[a * stride + j]
  const double* inverse_gamma =
      nullptr;  ///< diag Γ⁻¹: 1/r for damages, -1/k for supports, 0 if rigid
  /// Entry (a, b <= a) number t of c cᵀ, row j (a near mode, then a term of the series), is at
  /// pairs[((t / kPairChunk) * rows + j) * kPairChunk + t % kPairChunk], rows = near + terms.
  const double* pairs = nullptr;

  [[nodiscard]] int pair_count() const { return columns * (columns + 1) / 2; }
  [[nodiscard]] int chunks() const { return (pair_count() + kPairChunk - 1) / kPairChunk; }
};

/// With modes p and p + 1 (`lower_pole`) left out of F, A(λ) = Γ⁻¹ - F(λ) has no pole near λ, and
/// the damaged modes solve H(λ) v = 0,
///
///   H(λ) = diag(λ_p - λ, λ_{p+1} - λ) - [c_p c_{p+1}]ᵀ A(λ)⁻¹ [c_p c_{p+1}],  -H' =: N positive
///   definite.
///
/// det(H + d N̄) = 0 with H' = -N gives two steps d from λ to roots, right to second order.
struct SecularSteps {
  Pack low, high;  ///< the two steps, low <= high
  Pack negative;   ///< negative inertia of A
  Pack h11, h12, h22, n11, n12, n22;
};

/// Scratch for `evaluate`, sized once.
struct SecularScratch {
  std::vector<Pack> weights, slopes;  // near + terms
  std::vector<Pack> matrix;           // m (m + 1) / 2 rounded up to chunks
  std::vector<Pack> slope_matrix;     // the same
  std::vector<Pack> poles;            // 2 m: c_p, c_{p+1} of each lane; replaced by A⁻¹ of them
  std::vector<Pack> forward;          // 2 m

  void reserve(int columns, int rows);
};

/// Evaluates at `lambda`, whose nearest modes are `lower_pole` and the next.
void evaluate(const Secular& secular, const Pack& lambda, const int (&lower_pole)[kLanes],
              SecularScratch& scratch, SecularSteps& steps);

/// Fills `pairs` (chunks() · rows · kPairChunk) from c: products of the near modes, and the series
/// of the far ones, near <= j < modes. series[p * (modes - near) + j] weighs mode near + j in term
/// p and is negligible from series_end[p] on.
void fill_pairs(const Secular& secular, int modes, const double* series, const int* series_end,
                double* product, double* pairs);

/// out[j] = c_jᵀ η / (λ_j - λ), j < modes: what the mode with forces η has of every intact mode;
/// the two modes from `pole` on are left to the caller.
void coordinates(const Secular& secular, int modes, const double* eta, double lambda, int pole,
                 double* out);

/// out[r] = Σ_j rows[r * stride + j] x[j], j < size.
void project(const double* rows, int count, std::size_t stride, const double* x, int size,
             double* out);

}  // namespace wheeltap::fem::detail
