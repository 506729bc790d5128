// Designs of experiments: which points of a box the model is run at.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "base/eigen.hpp"

namespace wheeltap::emulator {

/// One run or one design point a row, so that a row is contiguous.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The coordinate s(x) in which an interpolant works along one factor; strictly monotone in x.
/// A frequency answers nearly linearly to the compliance that damage adds, s(r) = 1/(1-r), so a few
/// levels of a reduction r interpolate far better in it than in r itself.
enum class Scale {
  linear,      ///< s = x
  compliance,  ///< s = 1/(1-x), x < 1: x is a stiffness reduction
  reciprocal,  ///< s = -1/x, x > 0: x is a stiffness multiplier (the sign keeps s increasing)
  logarithm    ///< s = ln x, x > 0
};

/// The name written in table files, e.g. "compliance".
[[nodiscard]] std::string_view name(Scale scale);
/// Inverse of `name`. Throws std::invalid_argument for another text.
[[nodiscard]] Scale scale_named(std::string_view text);
/// s(x).
[[nodiscard]] double to_scale(Scale scale, double x);
/// x(s), the inverse of `to_scale`.
[[nodiscard]] double from_scale(Scale scale, double s);

/// One input of the model and the values a design gives it.
struct Factor {
  std::string name;            ///< unique within a design
  std::string unit;            ///< "" for a pure number
  std::vector<double> levels;  ///< strictly increasing, in `unit`; the first and last are its range
  Scale scale = Scale::linear;

  [[nodiscard]] double low() const { return levels.front(); }
  [[nodiscard]] double high() const { return levels.back(); }
};

/// Throws std::invalid_argument naming the factor unless there is at least one factor, names are
/// given and unique, every factor has at least `least_levels` finite, strictly increasing levels,
/// and its scale is defined on them.
void check_factors(const std::vector<Factor>& factors, std::size_t least_levels = 2);

/// True where x has one value per factor and each lies in its factor's range (NaN does not).
[[nodiscard]] bool contains(const std::vector<Factor>& factors, std::span<const double> x);

/// Throws std::invalid_argument when x does not have one value per factor, and std::out_of_range
/// naming the first factor whose value lies outside its range, with value and bounds.
void require_inside(const std::vector<Factor>& factors, std::span<const double> x);

/// Points at which a model is run.
struct Design {
  std::vector<Factor> factors;
  RowMatrix points;  ///< runs × factors, in the factors' units

  [[nodiscard]] Eigen::Index runs() const { return points.rows(); }
  [[nodiscard]] std::span<const double> point(Eigen::Index run) const {
    return {points.row(run).data(), factors.size()};
  }
};

/// Every combination of levels, the last factor running fastest. Throws std::invalid_argument for
/// bad factors (`check_factors` with one level enough) or more than 2³¹ runs.
[[nodiscard]] Design full_factorial(std::vector<Factor> factors);

/// n points uniform on the box of the factors' ranges, independent of each other.
[[nodiscard]] Design random_design(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// Latin hypercube: each factor's range is cut in n equal parts (in its scale) and each part is
/// used once, at its middle. Swaps within columns then spread the points by lowering φ_p = (Σ_{i<j}
/// d_ij^-p)^(1/p), p = 15, d in the unit cube, whose limit p → ∞ is the maximin distance (Morris &
/// Mitchell 1995, Exploratory designs for computational experiments, section 3).
[[nodiscard]] Design latin_hypercube(std::vector<Factor> factors, Eigen::Index n,
                                     std::uint64_t seed);

/// The first n points of Sobol's sequence (Joe & Kuo's direction numbers, through Boost) on the
/// box, uniform in each factor's scale, under a random digital shift drawn from `seed`.
[[nodiscard]] Design sobol(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// The design and then the 2^d corners of its box that it does not have yet: with them, the convex
/// hull of the runs is the whole box. Throws std::invalid_argument for more than 20 factors.
[[nodiscard]] Design with_corners(Design design);

}  // namespace wheeltap::emulator
