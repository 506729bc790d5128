// Outlines of cross-sections: polygons with holes, one region per material.
//
//        z ^
//          |     y is along the width, z along the depth. The beam's axis x points to the reader,
//          +--> y   so that x, y, z are right-handed (y × z = x).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace wheeltap::fem {

/// The corners (y, z) of a closed polygon in clockwise or counter-clockwise order [m]. The last
/// corner may repeat the first corner.
using Ring = std::vector<Eigen::Vector2d>;

/// A part of a section made of one material.
struct Region {
  Ring outer;
  std::vector<Ring> holes = {};
  double modulus = 1.0;  ///< E / E_ref
  double poisson = 0.3;
  double density = 1.0;  ///< [kg/m³]
};

/// An outline of regions that do not overlap. Two regions that touch are bonded along their common
/// boundary.
struct Outline {
  std::vector<Region> regions;
};

/// Tolerance of distances, divided by the size of the section. Two corners with a distance below
/// this tolerance count as one corner. A corner whose distance from an edge of another region is
/// below this tolerance lies on the edge.
inline constexpr double kSameCorner = 1e-9;

/// Returns the largest distance of a corner from the first corner of the outline [m].
[[nodiscard]] double outline_size(const Outline& outline);

/// The faulty part of an outline.
struct OutlinePlace {
  enum class Part { region, outer, hole, modulus, poisson, density };
  std::size_t region = 0;
  Part part = Part::region;
  std::size_t hole = 0;                    ///< index, for Part::hole
  std::optional<std::size_t> corner = {};  ///< index of the faulty corner in the ring, if any
};

/// The error for an invalid outline: "regions[0].holes[1][4]: (nan, 0): must be finite". Indices
/// start at 0.
struct OutlineError : std::invalid_argument {
  OutlineError(const OutlinePlace& where, const std::string& name, const std::string& why)
      : std::invalid_argument(name + ": " + why), place(where), reason(why) {}
  OutlinePlace place;
  std::string reason;  ///< message without the name of the faulty part
};

/// Checks an outline and returns it without repeated corners, with outer rings counter-clockwise
/// and holes clockwise. Neighbouring corners of a ring within the tolerance kSameCorner are merged.
/// Throws OutlineError, with the faulty part and the value, for
/// - coordinates that are not finite, fewer than 3 corners, zero area;
/// - a ring that crosses or touches itself, a hole that leaves its region or touches another hole;
/// - regions that overlap;
/// - a modulus or density that is not positive, a Poisson's ratio outside (-1, 0.5].
/// and std::invalid_argument for an outline without regions.
[[nodiscard]] Outline checked(const Outline& outline);

/// Computes the signed area ½ Σ (y_i z_{i+1} - y_{i+1} z_i) [m²]; it is positive for a
/// counter-clockwise ring.
[[nodiscard]] double signed_area(std::span<const Eigen::Vector2d> ring);

/// True if the point lies inside the ring (even-odd rule).
[[nodiscard]] bool contains(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point);

/// Builds regions of one material from rings that do not cross. A ring inside an even number of
/// other rings is a region. A ring inside an odd number of other rings is a hole of the smallest
/// region around this ring.
[[nodiscard]] std::vector<Region> nested(const std::vector<Ring>& rings);

/// Computes the corners of an arc from `from` (inclusive) to `to` (exclusive) over the angle `turn`
/// [rad], in steps of at most 2π / `per_turn`. The arc is counter-clockwise for a positive angle.
/// The corners between the ends lie slightly outside the circle, so that polygon and circular
/// segment have exactly the same area. Throws std::invalid_argument for a turn of 0 or beyond 2π.
[[nodiscard]] Ring arc(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double turn,
                       int per_turn = 256);

/// Computes a regular polygon with the same area as the circle.
[[nodiscard]] Ring circle(const Eigen::Vector2d& centre, double radius, int corners = 256);

}  // namespace wheeltap::fem
