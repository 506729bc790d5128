// Closed outlines from drawings: ASCII DXF (AutoCAD DXF Reference, "ENTITIES section").
//
//   file   = (code newline value newline)…    pairs; code 0 begins an entity
//
// LWPOLYLINE, POLYLINE with its VERTEX and CIRCLE are outlines of their own where they close; LINE,
// ARC and open polylines are joined end to end. Texts, dimensions, points and hatches are left out;
// entities that might belong to an outline but are not read (SPLINE, ELLIPSE, INSERT) are refused.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// A corner and the edge that leaves it: straight for bulge 0, else an arc of the angle
/// 4 atan(bulge), counter-clockwise where positive.
struct PathCorner {
  double x, y;
  double bulge = 0.0;
};
using ClosedPath = std::vector<PathCorner>;

struct Drawing {
  std::vector<ClosedPath> outlines;  ///< as drawn, in the file's unit
  double unit = 0.0;                 ///< in metres, by $INSUNITS; 0: the file has none
};

/// Ends of edges are joined where they lie within 1e-6 of the drawing's size. Throws FileError
/// (foreign) for what is no ASCII DXF, (corrupt) with the line for broken pairs and entities, for
/// edges that do not close and for a drawing without outlines. `name` stands for the file in
/// messages.
[[nodiscard]] Drawing parse_dxf(const std::string& bytes, const std::filesystem::path& name);

/// Metres of a unit by name: "m", "cm", "mm", "in", "ft"; 0 for another.
[[nodiscard]] double metres(const std::string& unit);

}  // namespace wheeltap::io
