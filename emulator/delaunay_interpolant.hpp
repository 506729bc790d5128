// Linear interpolation of runs at scattered points. This code is built if CGAL is available (CMake
// option WHEELTAP_WITH_CGAL). CGAL's triangulations in any dimension have the licence GPL-3 or
// later, so a program that links wheeltap::emulator_delaunay must be distributed under this
// licence.
#pragma once

#include <cstdint>
#include <vector>

#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// An interpolant that is continuous, and linear on every simplex of the Delaunay triangulation of
/// the runs. The triangulation uses the factors' scale coordinates, with each range mapped to [0,
/// 1]. Let v_0 … v_d be the vertices of the simplex that contains x. Then f(x) = Σ λ_i f(v_i), with
/// Σ λ_i v_i = x, Σ λ_i = 1 and λ_i >= 0. The interpolant is exact at the runs, and reproduces
/// functions that are linear in the scale coordinates. The error is of second order in the distance
/// between runs. CGAL triangulates with exact predicates. The search for the simplex that contains
/// x starts from a nearby simplex and steps through adjacent simplices (Devillers, Pion & Teillaud
/// 2002, Walking in a triangulation). The search uses floating-point arithmetic and does not
/// allocate memory. Several threads may call `evaluate` at once.
class DelaunayInterpolant final : public Interpolant {
 public:
  /// Largest number of factors. The number of simplices grows steeply with the number of factors.
  static constexpr std::size_t kMostFactors = 5;

  /// `points` has the size runs × factors, and `values` runs × responses. Throws
  /// std::invalid_argument for invalid factors or more than kMostFactors, inconsistent sizes,
  /// points outside the factors' ranges, duplicate points and values that are not finite. Also
  /// throws std::invalid_argument for fewer than d + 1 points, and for points that all lie in a
  /// hyperplane. Also throws std::invalid_argument for full-factorial grids of two or more factors:
  /// the corners of a cell lie on a sphere, so the triangulation is not unique. For grids, use
  /// MultilinearInterpolant.
  DelaunayInterpolant(std::vector<Factor> factors, const RowMatrix& points, RowMatrix values);

  /// Writes all responses at x to `out`. Throws std::out_of_range, naming x, if x lies outside the
  /// convex hull of the runs or is NaN. Throws std::invalid_argument for wrong sizes.
  void evaluate(std::span<const double> x, std::span<double> out) const override;

  /// True if x is inside the convex hull of the runs.
  [[nodiscard]] bool contains(std::span<const double> x) const override;
  [[nodiscard]] std::size_t simplices() const { return simplices_.size() / (dimension() + 1); }
  [[nodiscard]] const std::vector<Factor>& factors() const { return factors_; }
  [[nodiscard]] Eigen::Index responses() const { return values_.cols(); }

 private:
  using Coordinates = double[kMostFactors];
  using Weights = double[kMostFactors + 1];

  [[nodiscard]] std::size_t dimension() const { return factors_.size(); }
  void to_unit(std::span<const double> x, Coordinates& u) const;
  void weights(std::size_t simplex, const Coordinates& u, Weights& lambda) const;
  bool locate(const Coordinates& u, std::size_t& simplex, Weights& lambda) const;
  [[nodiscard]] std::size_t hint(const Coordinates& u) const;

  std::vector<Factor> factors_;
  std::vector<double> low_, range_;  // range of each scale coordinate
  RowMatrix unit_points_;
  RowMatrix values_;
  std::vector<std::int32_t> simplices_;   // d + 1 runs per simplex
  std::vector<std::int32_t> neighbours_;  // the adjacent simplex opposite each vertex; -1 outside
                                          // the hull
  std::vector<double> inverses_;          // d × d per simplex: [v_1 - v_0, …, v_d - v_0]⁻¹
  std::size_t cells_a_side_ = 1;
  std::vector<std::int32_t> hints_;  // a simplex near the centre of each cell
};

/// Trains a DelaunayInterpolant on a table. This function is defined in
/// wheeltap::emulator_delaunay.
[[nodiscard]] std::unique_ptr<const Interpolant> train_delaunay(Table& table,
                                                                const TrainingOptions& options);

/// Returns the description of the interpolant type. `train` is `train_delaunay`, or a function that
/// reports the missing build option.
[[nodiscard]] constexpr InterpolantType delaunay_type(InterpolantType::Train train) {
  return {.name = "delaunay",
          .words = "Delaunay interpolation",
          .runs = InterpolantType::Runs::scattered,
          .most_factors = DelaunayInterpolant::kMostFactors,
          .within_hull = true,
          .train = train};
}

}  // namespace wheeltap::emulator
