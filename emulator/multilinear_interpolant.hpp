// Multilinear interpolation on a full-factorial grid of any dimension, all responses at once.
#pragma once

#include "emulator/grid.hpp"
#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// In the cell that contains x, with t_j ∈ [0, 1] the position of s_j(x_j) between its two levels,
///   f(x) = Σ over the 2^d corners c of  Π_j (c_j ? t_j : 1 - t_j) · f_c.
/// Exact at every node; reproduces functions that are linear in each s_j separately. Evaluations do
/// not allocate memory and may run in several threads at once.
class MultilinearInterpolant final : public Interpolant {
 public:
  /// Largest number of factors: the 2^d corner weights are on the stack.
  static constexpr std::size_t kMostFactors = 12;

  /// `values`: runs × responses, rows in the order of `full_factorial(factors)`. Throws
  /// std::invalid_argument for invalid factors (at least two levels each, at most kMostFactors), a
  /// row count that is not the product of the level counts, no responses, or values that are not
  /// finite.
  MultilinearInterpolant(std::vector<Factor> factors, RowMatrix values);

  /// Writes all responses at x (one value per factor) to `out` (one value per response). Throws
  /// std::out_of_range, naming factor, value and bounds, if x lies outside the grid's box or is
  /// NaN: there is no extrapolation. Throws std::invalid_argument for wrong sizes.
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
};

extern const InterpolantType kMultilinear;

}  // namespace wheeltap::emulator
