// Designs of experiments: the points of the parameter domain (a box) at which the model is run.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "base/eigen.hpp"

namespace wheeltap::emulator {

/// A matrix with one run or one design point per row. The entries of a row are contiguous in
/// memory.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The strictly monotone transformation s(x) of one factor. Interpolants use the coordinate s. A
/// natural frequency is nearly linear in the compliance s(r) = 1/(1-r) for a stiffness reduction r.
/// With few levels of r, interpolation in s is therefore far more accurate than interpolation in r.
enum class Scale {
  linear,      ///< s = x
  compliance,  ///< s = 1/(1-x), x < 1: x is a stiffness reduction
  reciprocal,  ///< s = -1/x, x > 0: x is a stiffness multiplier (the sign keeps s increasing)
  logarithm    ///< s = ln x, x > 0
};

/// Returns the name of a scale in table files, for example "compliance".
[[nodiscard]] std::string_view name(Scale scale);
/// Returns the scale with this name. Throws std::invalid_argument for an unknown name.
[[nodiscard]] Scale scale_named(std::string_view text);
/// Computes the scale coordinate s(x).
[[nodiscard]] double to_scale(Scale scale, double x);
/// Computes x(s), the inverse of `to_scale`.
[[nodiscard]] double from_scale(Scale scale, double s);

/// One input of the model and its levels in a design.
struct Factor {
  std::string name;            ///< unique within a design
  std::string unit;            ///< "" if dimensionless
  std::vector<double> levels;  ///< strictly increasing, in `unit`; the range is from the first to
                               ///< the last level
  Scale scale = Scale::linear;

  [[nodiscard]] double low() const { return levels.front(); }
  [[nodiscard]] double high() const { return levels.back(); }
};

/// Checks the factors of a design. At least one factor must be given; names must be unique and not
/// empty. Every factor must have at least `least_levels` finite, strictly increasing levels for
/// which its scale is defined. Throws std::invalid_argument, naming the factor, if a condition is
/// not met.
void check_factors(const std::vector<Factor>& factors, std::size_t least_levels = 2);

/// True if x has one value per factor, and each value is within the range of its factor (false for
/// NaN).
[[nodiscard]] bool contains(const std::vector<Factor>& factors, std::span<const double> x);

/// Throws std::invalid_argument if x does not have one value per factor. Throws std::out_of_range
/// if a value lies outside the range of its factor; the message names the first such factor, the
/// value and the bounds.
void require_inside(const std::vector<Factor>& factors, std::span<const double> x);

/// A design: the points at which a model is run.
struct Design {
  std::vector<Factor> factors;
  RowMatrix points;  ///< runs × factors, in the factors' units

  [[nodiscard]] Eigen::Index runs() const { return points.rows(); }
  [[nodiscard]] std::span<const double> point(Eigen::Index run) const {
    return {points.row(run).data(), factors.size()};
  }
};

/// Creates the design of all combinations of levels; the last factor varies fastest. Throws
/// std::invalid_argument for invalid factors (`check_factors` with at least one level) or more than
/// 2³¹ runs.
[[nodiscard]] Design full_factorial(std::vector<Factor> factors);

/// Draws n independent points with the uniform distribution on the box of the factors' ranges.
[[nodiscard]] Design random_design(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// Creates a Latin hypercube design. The range of each factor is divided into n equal parts (in its
/// scale), and the middle of each part occurs once in the design. Exchanges of values within
/// columns then minimise φ_p = (Σ_{i<j} d_ij^-p)^(1/p), p = 15, with the distances d between points
/// in the unit cube. For p → ∞, this criterion is the maximin distance (Morris & Mitchell 1995,
/// Exploratory designs for computational experiments, section 3).
[[nodiscard]] Design latin_hypercube(std::vector<Factor> factors, Eigen::Index n,
                                     std::uint64_t seed);

/// Creates a design from the first n points of Sobol's sequence on the box of the factors' ranges
/// (direction numbers of Joe & Kuo, from Boost). The points are uniform in the scale of each
/// factor; a random digital shift is drawn with `seed`.
[[nodiscard]] Design sobol(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed);

/// Appends the corners of the box to a design, except corners that the design already contains. The
/// convex hull of the points is then the whole box with its 2^d corners. Throws
/// std::invalid_argument for more than 20 factors.
[[nodiscard]] Design with_corners(Design design);

}  // namespace wheeltap::emulator
