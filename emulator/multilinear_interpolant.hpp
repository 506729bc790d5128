// Multilinear interpolation of all responses on a full-factorial grid of any dimension.
#pragma once

#include "emulator/grid.hpp"
#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// A multilinear interpolant. In the cell that contains x, with the position t_j ∈ [0, 1] of
/// s_j(x_j) between the two levels of factor j,
///   f(x) = Σ over the 2^d corners c of  Π_j (c_j ? t_j : 1 - t_j) · f_c.
/// The interpolant is exact at every node, and reproduces functions that are linear in each s_j
/// separately. Evaluations do not allocate memory. Several threads may call `evaluate` at once.
class MultilinearInterpolant final : public Interpolant {
 public:
  /// Largest number of factors. The number d of factors is limited because the 2^d weights of the
  /// corners of a grid cell are stored on the stack.
  static constexpr std::size_t kMostFactors = 12;

  /// `values` has the size runs × responses, with rows in the order of `full_factorial(factors)`.
  /// Throws std::invalid_argument for invalid factors (at least two levels each, at most
  /// kMostFactors factors), a number of rows that is not the product of the numbers of levels, zero
  /// responses, or values that are not finite.
  MultilinearInterpolant(std::vector<Factor> factors, RowMatrix values);

  /// Writes all responses at x (one value per factor) to `out` (one value per response). Throws
  /// std::out_of_range, naming factor, value and bounds, if x lies outside the range of the grid or
  /// is NaN, because interpolants do not extrapolate. Throws std::invalid_argument for wrong sizes.
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
