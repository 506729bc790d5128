// Designs of experiments: points of a box at which the model is run.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "base/eigen.hpp"

namespace wheeltap::emulator {

/// One run or one design point per row, so that a row is contiguous.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The transformation s(x) of one factor, strictly monotone, in which interpolants work. A
/// frequency is nearly linear in the compliance of a damage, s(r) = 1/(1-r). With few levels of a
/// stiffness reduction r, interpolation in s is therefore far more accurate than in r.
enum class Scale {
  linear,      ///< s = x
  compliance,  ///< s = 1/(1-x), x < 1: x is a stiffness reduction
  reciprocal,  ///< s = -1/x, x > 0: x is a stiffness multiplier (the sign keeps s increasing)
  logarithm    ///< s = ln x, x > 0
};

/// Name in table files, e.g. "compliance".
[[nodiscard]] std::string_view name(Scale scale);
/// Inverse of `name`. Throws std::invalid_argument for an unknown text.
[[nodiscard]] Scale scale_named(std::string_view text);
/// s(x).
[[nodiscard]] double to_scale(Scale scale, double x);
/// x(s), the inverse of `to_scale`.
[[nodiscard]] double from_scale(Scale scale, double s);

/// One input of the model and its levels in a design.
struct Factor {
  std::string name;            ///< unique within a design
  std::string unit;            ///< "" if dimensionless
  std::vector<double> levels;  ///< strictly increasing, in `unit`; the first and last are its range
  Scale scale = Scale::linear;

  [[nodiscard]] double low() const { return levels.front(); }
  [[nodiscard]] double high() const { return levels.back(); }
};

/// Throws std::invalid_argument, naming the factor, unless there is at least one factor, names are
/// given and unique, every factor has at least `least_levels` finite, strictly increasing levels,
/// and its scale is defined on them.
void check_factors(const std::vector<Factor>& factors, std::size_t least_levels = 2);

/// True if x has one value per factor, each within its factor's range (false for NaN).
[[nodiscard]] bool contains(const std::vector<Factor>& factors, std::span<const double> x);

/// Throws std::invalid_argument if x does not have one value per factor, and std::out_of_range,
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

/// All combinations of levels, the last factor varying fastest. Throws std::invalid_argument for
/// invalid factors (`check_factors` with at least one level) or more than 2³¹ runs.
[[nodiscard]] Design full_factorial(std::vector<Factor> factors);

/// n independent points, uniform on the box of the factors' ranges.
[[nodiscard]] Design random_design(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// Latin hypercube: each factor's range is divided into n equal parts (in its scale) and the middle
/// of each part is used once. Swaps within columns then spread the points by minimising φ_p =
/// (Σ_{i<j} d_ij^-p)^(1/p), p = 15, d in the unit cube, which for p → ∞ gives the maximin distance
/// (Morris & Mitchell 1995, Exploratory designs for computational experiments, section 3).
[[nodiscard]] Design latin_hypercube(std::vector<Factor> factors, Eigen::Index n,
                                     std::uint64_t seed);

/// The first n points of Sobol's sequence (Joe & Kuo's direction numbers, from Boost) on the box,
/// uniform in each factor's scale, with a random digital shift drawn from `seed`.
[[nodiscard]] Design sobol(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// The design, followed by those of the 2^d corners of its box that it does not contain. The convex
/// hull of the runs is then the whole box. Throws std::invalid_argument for more than 20 factors.
[[nodiscard]] Design with_corners(Design design);

}  // namespace wheeltap::emulator
