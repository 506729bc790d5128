// Cubic interpolation of all responses on a full-factorial grid, optionally monotone.
#pragma once

#include "emulator/grid.hpp"
#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// Interpolation rule along one factor.
enum class AxisRule {
  linear,         ///< piecewise linear
  cubic,          ///< cubic Hermite polynomials with the slopes of parabolas through three levels
  monotone_cubic  ///< cubic, with slopes limited so that the interpolant is monotone between levels
};

/// An interpolant on a grid. The interpolation runs first along the last factor, on every line of
/// the local stencil, then along the preceding factor, and so on. In one dimension, let y_0 and y_1
/// be the values at the levels s_0 and s_1 = s_0 + h. With t = (s - s_0)/h, the interpolant is
///   p(t) = y_0 + t h [d_0 + t (3Δ - 2d_0 - d_1 + t (d_0 + d_1 - 2Δ))],  Δ = (y_1 - y_0)/h,
/// d_0 and d_1 are the slopes of the parabolas through three neighbouring levels (one-sided at the
/// ends of the range). The rule monotone_cubic sets d to 0 at levels where the secants on both
/// sides differ in sign. At other levels, this rule limits d to three times the smaller secant.
/// This limit is sufficient for a monotone interpolant between two levels (Fritsch & Carlson 1980,
/// Monotone piecewise cubic interpolation, section 3). The interpolant is exact at the nodes of the
/// grid. The rule cubic reproduces parabolas; monotone_cubic reproduces parabolas if the limit of d
/// is not active. For smooth data, the error is of third order in the spacing. If monotone_cubic
/// limits d near an extremum, the error there is of second order. Use the rule cubic for a factor
/// along which responses oscillate. If the value of a factor equals a level, no interpolation along
/// this factor is necessary. Evaluations do not allocate memory. Several threads may call
/// `evaluate` at once.
class CubicInterpolant final : public Interpolant {
 public:
  /// Largest number of stencil nodes in an evaluation. The number of nodes is the product of one
  /// number per factor: 4 (cubic) or 2 (linear).
  static constexpr std::size_t kMostNodes = 4096;

  /// `values` has the size runs × responses, with rows in the order of `full_factorial(factors)`.
  /// `rules` holds the interpolation rule of each factor. Throws the exceptions of `grid_axes`, and
  /// std::invalid_argument for a wrong number of rules or a stencil of more than kMostNodes.
  CubicInterpolant(std::vector<Factor> factors, RowMatrix values, std::vector<AxisRule> rules);

  /// Writes all responses at x to `out`. Throws std::out_of_range for x outside the box of the
  /// factors' ranges, like MultilinearInterpolant.
  void evaluate(std::span<const double> x, std::span<double> out) const override;

  [[nodiscard]] bool contains(std::span<const double> x) const override {
    return emulator::contains(factors_, x);
  }
  [[nodiscard]] const std::vector<Factor>& factors() const { return factors_; }
  [[nodiscard]] const RowMatrix& values() const { return values_; }
  [[nodiscard]] Eigen::Index responses() const { return values_.cols(); }

 private:
  std::vector<Factor> factors_;
  std::vector<GridAxis> axes_;
  RowMatrix values_;
  std::vector<AxisRule> rules_;
};

/// Interpolant type with the rule cubic for factors along which responses oscillate
/// (TrainingOptions::waves), and the rule monotone_cubic for the other factors.
extern const InterpolantType kCubic;
/// Interpolant type with the rule monotone_cubic along every factor.
extern const InterpolantType kMonotoneCubic;

}  // namespace wheeltap::emulator
