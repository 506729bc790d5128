// Outlines of cross-sections: polygons with holes, one region per material.
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

/// The corners (y, z) of a closed polygon in order, in either direction [m]. The last corner may
/// repeat the first.
using Ring = std::vector<Eigen::Vector2d>;

/// A part of a section made of one material.
struct Region {
  Ring outer;
  std::vector<Ring> holes = {};
  double modulus = 1.0;  ///< E / E_ref
  double poisson = 0.3;
  double density = 1.0;  ///< [kg/m³]
};

/// Regions that do not overlap. Two regions that touch are joined along their common boundary.
struct Outline {
  std::vector<Region> regions;
};

/// Tolerance of distances, relative to the size of the section. Two corners within it count as one
/// corner, and a corner within it from an edge of another region lies on that edge.
inline constexpr double kSameCorner = 1e-9;

/// The largest distance of a corner from the outline's first one [m].
[[nodiscard]] double outline_size(const Outline& outline);

/// The faulty part of an outline.
struct OutlinePlace {
  enum class Part { region, outer, hole, modulus, poisson, density };
  std::size_t region = 0;
  Part part = Part::region;
  std::size_t hole = 0;                    ///< index, for Part::hole
  std::optional<std::size_t> corner = {};  ///< index in the ring, if one corner is wrong
};

/// "regions[0].holes[1][4]: (nan, 0): must be finite". Numbers count from 0.
struct OutlineError : std::invalid_argument {
  OutlineError(const OutlinePlace& where, const std::string& name, const std::string& why)
      : std::invalid_argument(name + ": " + why), place(where), reason(why) {}
  OutlinePlace place;
  std::string reason;  ///< without the place
};

/// Checks an outline and returns it without repeated corners, with outer rings counter-clockwise
/// and holes clockwise. Neighbouring corners of a ring within the tolerance kSameCorner are merged.
/// Throws OutlineError, with place and value, for
/// - coordinates that are not finite, fewer than 3 corners, no area;
/// - a ring that crosses or touches itself, or a hole that leaves its region or meets another hole;
/// - regions that overlap;
/// - a modulus or density that is not positive, a Poisson's ratio outside (-1, 0.5].
/// and std::invalid_argument for an outline without regions.
[[nodiscard]] Outline checked(const Outline& outline);

/// ½ Σ (y_i z_{i+1} - y_{i+1} z_i): positive counter-clockwise [m²].
[[nodiscard]] double signed_area(std::span<const Eigen::Vector2d> ring);

/// True if the point lies inside the ring (even-odd rule).
[[nodiscard]] bool contains(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point);

/// Builds regions of one material from rings that do not cross. A ring inside an even number of
/// others is a region; a ring inside an odd number is a hole of the smallest region around it.
[[nodiscard]] std::vector<Region> nested(const std::vector<Ring>& rings);

/// The corners of an arc from `from` (inclusive) to `to` (exclusive) over the angle `turn` [rad],
/// counter-clockwise if positive, in steps of at most 2π / `per_turn`. The corners in between lie
/// slightly outside the circle, so that the polygon has exactly the area of the circular segment.
/// Throws std::invalid_argument for a turn of 0 or beyond 2π.
[[nodiscard]] Ring arc(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double turn,
                       int per_turn = 256);

/// A regular polygon with the area of the circle.
[[nodiscard]] Ring circle(const Eigen::Vector2d& centre, double radius, int corners = 256);

}  // namespace wheeltap::fem
