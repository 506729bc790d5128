// Linear interpolation between scattered runs. Built if CGAL is available (CMake option
// WHEELTAP_WITH_CGAL). CGAL's triangulations in any dimension have the licence GPL-3 or later, so a
// program that links wheeltap::emulator_delaunay must be distributed under those terms.
#pragma once

#include <cstdint>
#include <vector>

#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// Continuous and linear on every simplex of the Delaunay triangulation of the runs (in the
/// factors' scale coordinates, each range mapped to [0, 1]). In the simplex with vertices v_0 … v_d
/// that contains x, f(x) = Σ λ_i f(v_i), Σ λ_i v_i = x, Σ λ_i = 1, λ_i >= 0. Exact at the runs;
/// reproduces functions linear in the scale coordinates; the error is of second order in the
/// distance between runs. CGAL triangulates with exact predicates. The simplex that contains x is
/// found by stepping through adjacent simplices from a nearby one (Devillers, Pion & Teillaud 2002,
/// Walking in a triangulation), in floating-point arithmetic and without allocation. Several
/// threads may evaluate it at once.
class DelaunayInterpolant final : public Interpolant {
 public:
  /// The number of simplices grows steeply with the dimension.
  static constexpr std::size_t kMostFactors = 5;

  /// `points`: runs × factors, `values`: runs × responses. Throws std::invalid_argument for invalid
  /// factors or more than kMostFactors, shapes that disagree, points outside the factors' ranges,
  /// duplicate points, values that are not finite, and points that all lie in a hyperplane (or are
  /// fewer than d + 1). Also throws it for full-factorial grids of two or more factors, because the
  /// corners of a cell lie on a sphere and their triangulation is arbitrary; use
  /// MultilinearInterpolant for grids.
  DelaunayInterpolant(std::vector<Factor> factors, const RowMatrix& points, RowMatrix values);

  /// All responses at x. Throws std::out_of_range, naming the point, if it lies outside the convex
  /// hull of the runs or is NaN; std::invalid_argument for wrong sizes.
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
  std::vector<std::int32_t> simplices_;   // d + 1 runs each
  std::vector<std::int32_t> neighbours_;  // the simplex opposite each vertex; -1 outside the hull
  std::vector<double> inverses_;          // d × d each: [v_1 - v_0, …, v_d - v_0]⁻¹
  std::size_t cells_a_side_ = 1;
  std::vector<std::int32_t> hints_;  // a simplex near each cell's centre
};

/// Defined in wheeltap::emulator_delaunay.
[[nodiscard]] std::unique_ptr<const Interpolant> train_delaunay(Table& table,
                                                                const TrainingOptions& options);

/// Description with training by `train`: `train_delaunay`, or a function that reports the missing
/// build option.
[[nodiscard]] constexpr InterpolantType delaunay_type(InterpolantType::Train train) {
  return {.name = "delaunay",
          .words = "Delaunay interpolation",
          .runs = InterpolantType::Runs::scattered,
          .most_factors = DelaunayInterpolant::kMostFactors,
          .within_hull = true,
          .train = train};
}

}  // namespace wheeltap::emulator
