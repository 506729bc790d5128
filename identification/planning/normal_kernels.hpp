// The slowest loops of NormalTest: normal integrals over severities, and weights of pairs.
#pragma once

#include <array>
#include <cstddef>

namespace wheeltap::identification::planning {

/// ln ∫ exp(b x - h x²/2) dx from `low` to `high`, h >= 0.
[[nodiscard]] double log_normal_integral(double b, double h, double low, double high);

/// The concave exponent q = constant + bx x + by y - (hxx x² + 2 hxy x y + hyy y²) / 2.
struct Quadratic {
  double constant, bx, by, hxx, hxy, hyy;
};
/// The rectangle x0 <= x <= x1, y0 <= y <= y1.
struct Rectangle {
  double x0, x1, y0, y1;
};

/// The point of the rectangle at which q is largest.
[[nodiscard]] std::array<double, 2> best_point(const Quadratic& q, const Rectangle& r);

/// Computes q at a point.
[[nodiscard]] double value_at(const Quadratic& q, const std::array<double, 2>& point);

/// ln ∫∫ exp(q) over the rectangle; `best` is its best_point. The integral has a closed form if, at
/// all relevant values of one variable, the rectangle contains nearly all the conditional
/// probability mass of the other variable. In all other cases, the integral along y has a closed
/// form, and 12-node Gauss-Legendre quadrature along x has a relative error below 1e-4.
[[nodiscard]] double log_integral(const Quadratic& q, const Rectangle& r,
                                  const std::array<double, 2>& best);

/// Number of pairs that one vector instruction processes.
inline constexpr std::size_t kPairLanes = 8;

/// Number of independent entries of a symmetric 4 × 4 matrix.
inline constexpr std::size_t kSymmetric = 10;

/// Pairs of one damage location a with several damage locations b. Array lengths are multiples of
/// kPairLanes.
struct PairRow {
  float amplitude;           ///< y · v_a; v_a is the unit direction of location a
  float bend;                ///< y · w_a; w_a is the direction of deviations from the line of v_a
  float slope;               ///< largest deviation along w_a, divided by the amplitude
  float limit;               ///< largest amplitude of location a
  const float* amplitudes;   ///< y · v_b
  const float* bends;        ///< y · w_b
  const float* slopes;       ///< slope of each location b
  const float* limits;       ///< limit of each location b
  const float* correlation;  ///< ρ = v_a · v_b
  const float* inverse;      ///< 1 / (1 - ρ²)
  const float* log_weight;   ///< term that is added to the largest exponent
  const float* interaction;  ///< |I| / (|Δ_a| |Δ_b|), 0 for no interaction
  /// Inverse of the Gram matrix of v_a, w_a, v_b and w_b: entries (0, 0), (0, 1), … (3, 3) of the
  /// upper triangle, each in a separate array, `stride` apart.
  const float* gram_inverse;
  std::size_t stride;
  std::size_t size;
};

/// If interaction, curvature and bounds change the exponent of a pair by less than this value, they
/// are neglected.
inline constexpr float kSmallChange = 0.3F;

/// Computes the ln of the approximate weight of each pair: `log_weight` plus the exponent at
/// amplitudes c between 0 and `limit` along both directions. Better amplitudes, the interaction and
/// the curvature would increase the exponent by at most about `extra`:
///
///   extra = f + min(r²/2, κ²/2 + 4 κ) + min(u, d √(2 u)).
///
/// Without limits of the amplitudes, the exponent would increase by f. The interaction has the size
/// κ = |I| c_a c_b / (|Δ_a| |Δ_b|), and the residual has the norm r. If the residual is the
/// interaction plus noise, the interaction increases the exponent by more than the second term with
/// probability 3e-5. With unlimited deviations of both effects along w_a and w_b, the exponent
/// would increase by u. The largest possible deviation is d = c_a slope_a + c_b slope_b. `square` =
/// |y|². Returns the largest `weight` among the pairs whose `extra` is below kSmallChange.
[[nodiscard]] float screen_pairs(const PairRow& row, float square, float* weight, float* extra);

/// Pairs of locations whose effects lie on curves c v + α c (c - τ) w, 0 <= c <= limit. Arrays of
/// `stride` entries in this order; the number of used entries is a multiple of kPairLanes.
struct CurvedPairs {
  enum Array {
    v_a,  ///< y · v_a
    w_a,  ///< y · w_a
    limit_a,
    alpha_a,
    tau_a,
    slope_a,  ///< largest deviation from the curved line, in units of the amplitude
    v_b,
    w_b,
    limit_b,
    alpha_b,
    tau_b,
    slope_b,
    rho,          ///< v_a · v_b
    vw,           ///< v_a · w_b
    wv,           ///< w_a · v_b
    ww,           ///< w_a · w_b
    interaction,  ///< |I| / (|Δ_a| |Δ_b|)
    count
  };
  const float* arrays;
  std::size_t stride, size;
};

/// Computes the largest exponent of each pair without interaction. Gauss-Newton steps start from
/// the result for straight lines (no curvature). `extra` is an approximate upper bound of the
/// increase of this exponent by two effects. The first effect is the interaction (as in
/// screen_pairs). The second effect, at most min(d r, r²/2), is a deviation d from the curves; r is
/// the norm of the residual. `square` = |y|².
void fit_curved_pairs(const CurvedPairs& pairs, float square, float* exponent, float* extra);

/// Replaces each of `size` values by exp(value - most), with a relative error below 1e-6; values
/// below most - 80 become exp(-80). `size` is a multiple of kPairLanes.
void exponentials(float* values, std::size_t size, float most);

/// The scalar product of two vectors of `size` entries; `size` is a multiple of kPairLanes.
[[nodiscard]] float scalar_product(const float* x, const float* y, std::size_t size);

/// Number of vectors in one tile of `products_with_tile`.
inline constexpr std::size_t kTile = 8;
/// Scalar products of kTile vectors with `count` columns, both of `rows` entries. `tile` holds
/// entry 0 of all vectors, then entry 1, and so on. Column c starts at
/// `columns` + c · `rows`. The products with column c are written to `out` + c · `out_stride`.
void products_with_tile(const double* tile, std::size_t rows, const double* columns,
                        std::size_t count, double* out, std::size_t out_stride);

}  // namespace wheeltap::identification::planning
