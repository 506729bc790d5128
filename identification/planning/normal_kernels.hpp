// The expensive loops of NormalTest: normal integrals over severities, and weights of pairs.
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

/// The point of the rectangle with the largest value.
[[nodiscard]] std::array<double, 2> best_point(const Quadratic& q, const Rectangle& r);

/// ln ∫∫ exp(q) over the rectangle; `best` is its best point. The integral has a closed form if the
/// normal density of one variable is inside the rectangle at all relevant values of the other one.
/// Otherwise the integral along y has a closed form, and 12-node Gauss-Legendre quadrature along x
/// has a relative error below 1e-4.
[[nodiscard]] double log_integral(const Quadratic& q, const Rectangle& r,
                                  const std::array<double, 2>& best);

/// Number of pairs that one instruction processes.
inline constexpr std::size_t kPairLanes = 8;

/// Pairs of one place a with several places b. All arrays have a multiple of kPairLanes entries.
struct PairRow {
  float amplitude;           ///< y · v_a, v_a the unit direction of place a
  const float* amplitudes;   ///< y · v_b
  const float* correlation;  ///< ρ = v_a · v_b
  const float* inverse;      ///< 1 / (1 - ρ²)
  const float* log_weight;   ///< added to the largest exponent
  const float* interaction;  ///< |I| / (|Δ_a| |Δ_b|), 0 for no interaction
  std::size_t size;
};

/// weight = ln of the approximate weight of each pair without the interaction: the largest exponent
/// over the amplitudes c_a, c_b >= 0 along both directions, plus log_weight. κ = |I| c_a c_b /
/// (|Δ_a| |Δ_b|) is the size of the interaction and r the norm of the residual. The interaction may
/// increase the exponent by
///
///   extra = min(r²/2, κ²/2 + 4 κ),
/// and more with probability 3e-5 if the interaction
/// describes the residual. `square` = |y|². Returns the
/// largest weight.
[[nodiscard]] float screen_pairs(const PairRow& row, float square, float* weight, float* extra);

}  // namespace wheeltap::identification::planning
