// Reading of closed outlines from drawings in the format ASCII DXF (AutoCAD DXF Reference,
// "ENTITIES section").
//
//   file   = (code newline value newline)…    pairs; code 0 begins an entity
//
// Each closed LWPOLYLINE, closed POLYLINE (with its VERTEX entities) and CIRCLE is one outline.
// LINE, ARC and open polylines are joined end to end. Text, dimensions, points and hatches are
// ignored. SPLINE, ELLIPSE and INSERT cause an error, because they might belong to an outline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// A corner of an outline and the edge that starts at this corner. If `bulge` is 0, the edge is
/// straight. For any other `bulge`, the edge is an arc of the angle 4 atan(bulge),
/// counter-clockwise for a positive bulge.
struct PathCorner {
  double x, y;
  double bulge = 0.0;
};
using ClosedPath = std::vector<PathCorner>;

struct Drawing {
  std::vector<ClosedPath> outlines;  ///< in the unit of the file
  double unit = 0.0;                 ///< metres per unit, from $INSUNITS; 0: not given
};

/// Parses a drawing. Edges are joined if the distance between their ends is at most 1e-6 of the
/// drawing's size. Throws FileError: foreign for bytes that are not an ASCII DXF drawing; corrupt,
/// with the line number, for invalid pairs and entities, for edges that form no closed outline and
/// for a drawing without outlines. Messages use `name` for the file.
[[nodiscard]] Drawing parse_dxf(const std::string& bytes, const std::filesystem::path& name);

/// Length in metres of the unit "m", "cm", "mm", "in" or "ft"; 0 for any other name.
[[nodiscard]] double metres(const std::string& unit);

}  // namespace wheeltap::io
