// The outline of a cross-section: polygons with holes, one a material.
//
//        z ^
//          |    y goes along the width, z along the height. The beam's axis x points at the reader,
//          +--> y   so that x, y, z are right-handed (y × z = x).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace wheeltap::fem {

/// The corners (y, z) of a closed polygon in order, either way round [m]. The last may repeat the
/// first.
using Ring = std::vector<Eigen::Vector2d>;

/// A part of a section, of one material.
struct Region {
  Ring outer;
  std::vector<Ring> holes = {};
  double modulus = 1.0;  ///< E / E_ref
  double poisson = 0.3;
  double density = 1.0;  ///< [kg/m³]
};

/// Regions side by side. Two that touch are joined along what they share.
struct Outline {
  std::vector<Region> regions;
};

/// Corners this close to each other, against the section's size, are one corner; a corner this
/// close to an edge of another region lies on it.
inline constexpr double kSameCorner = 1e-9;

/// The largest distance of a corner from the outline's first one [m].
[[nodiscard]] double outline_size(const Outline& outline);

/// Where something is wrong with an outline.
struct OutlinePlace {
  enum class Part { region, outer, hole, modulus, poisson, density };
  std::size_t region = 0;
  Part part = Part::region;
  std::size_t hole = 0;                    ///< of Part::hole
  std::optional<std::size_t> corner = {};  ///< of a ring, where one corner is wrong
};

/// "regions[0].holes[1][4]: (nan, 0): must be finite". Numbers count from 0.
struct OutlineError : std::invalid_argument {
  OutlineError(const OutlinePlace& where, const std::string& name, const std::string& why)
      : std::invalid_argument(name + ": " + why), place(where), reason(why) {}
  OutlinePlace place;
  std::string reason;  ///< without the place
};

/// Rings without repeated corners, outer ones counter-clockwise and holes clockwise. Neighbouring
/// corners of a ring within kSameCorner of the section's size are one corner. Throws
/// OutlineError, naming place and value, for
/// - coordinates that are not finite, fewer than 3 corners, no area;
/// - a ring that crosses or touches itself, or a hole that leaves its region or meets another hole;
/// - regions that overlap;
/// - a modulus or density that is not positive, a Poisson's ratio outside (-1, 0.5].
/// and std::invalid_argument for an outline without regions.
[[nodiscard]] Outline checked(const Outline& outline);

/// ½ Σ (y_i z_{i+1} - y_{i+1} z_i): positive counter-clockwise [m²].
[[nodiscard]] double signed_area(std::span<const Eigen::Vector2d> ring);

/// Whether the point lies inside the ring (even-odd rule).
[[nodiscard]] bool contains(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point);

/// Regions of one material from rings that do not cross: one that lies in an even number of others
/// is a region, one in an odd number a hole of the smallest region around it.
[[nodiscard]] std::vector<Region> nested(const std::vector<Ring>& rings);

/// An arc's corners from `from` (inclusive) to `to` (exclusive), `turn` [rad] counter-clockwise
/// (clockwise where negative), in steps of at most 2π / `per_turn`. The corners between lie a
/// little off the circle, so that the area is the arc's exactly. Throws std::invalid_argument for a
/// turn of 0 or beyond 2π.
[[nodiscard]] Ring arc(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double turn,
                       int per_turn = 256);

/// A regular polygon with the area of the circle.
[[nodiscard]] Ring circle(const Eigen::Vector2d& centre, double radius, int corners = 256);

}  // namespace wheeltap::fem
