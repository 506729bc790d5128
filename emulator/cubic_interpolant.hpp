// Cubic interpolation on a full-factorial grid, optionally monotone, all responses at once.
#pragma once

#include "emulator/grid.hpp"
#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// Interpolation rule along one factor.
enum class AxisRule {
  linear,         ///< piecewise linear
  cubic,          ///< cubic Hermite pieces with the slopes of the parabola through three neighbours
  monotone_cubic  ///< the same, with slopes limited so that no piece overshoots its two end values
};

/// Interpolates along the last factor first, on every line of the local stencil, then along the
/// preceding one, and so on. In one dimension, between levels s_0 < s_1 a distance h apart,
///   p(t) = y_0 + t h [d_0 + t (3Δ - 2d_0 - d_1 + t (d_0 + d_1 - 2Δ))],  Δ = (y_1 - y_0)/h,
/// where d are the slopes of the parabolas through three neighbouring levels (one-sided at the ends
/// of the range). The rule monotone_cubic sets d to 0 where the secants on both sides differ in
/// sign. Otherwise it limits d to three times the smaller secant, which is sufficient for a
/// monotone piece (Fritsch & Carlson 1980, Monotone piecewise cubic interpolation, section 3). The
/// result is exact at nodes. The rule cubic reproduces parabolas; monotone_cubic reproduces them
/// where the limit does not apply. The error is of third order in the spacing for smooth data, and
/// of second order where monotone_cubic flattens an extremum: use cubic along a factor with
/// oscillating responses. A factor whose value is exactly a level needs no interpolation.
/// Evaluations do not allocate memory and may run in several threads at once.
class CubicInterpolant final : public Interpolant {
 public:
  /// Largest number of stencil nodes (4 per cubic factor, 2 per linear one) in an evaluation.
  static constexpr std::size_t kMostNodes = 4096;

  /// `values`: runs × responses, rows in the order of `full_factorial(factors)`; `rules`: one per
  /// factor. Throws the exceptions of `grid_axes`, and std::invalid_argument for a wrong number of
  /// rules or a stencil of more than kMostNodes.
  CubicInterpolant(std::vector<Factor> factors, RowMatrix values, std::vector<AxisRule> rules);

  /// All responses at x. Throws std::out_of_range outside the box, as MultilinearInterpolant does.
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

/// Uses the rule cubic along factors with oscillating responses, and monotone_cubic along the
/// others.
extern const InterpolantType kCubic;
/// Uses the rule monotone_cubic along every factor.
extern const InterpolantType kMonotoneCubic;

}  // namespace wheeltap::emulator
