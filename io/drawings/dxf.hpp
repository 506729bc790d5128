// Closed outlines from drawings: ASCII DXF (AutoCAD DXF Reference, "ENTITIES section").
//
//   file   = (code newline value newline)…    pairs; code 0 begins an entity
//
// Each closed LWPOLYLINE, closed POLYLINE (with its VERTEX entities) and CIRCLE is one outline.
// LINE, ARC and open polylines are joined end to end. Texts, dimensions, points and hatches are
// ignored. SPLINE, ELLIPSE and INSERT cause an error, because they might belong to an outline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// A corner and the edge that starts there: straight for bulge 0, otherwise an arc of the angle 4
/// atan(bulge), counter-clockwise if positive.
struct PathCorner {
  double x, y;
  double bulge = 0.0;
};
using ClosedPath = std::vector<PathCorner>;

struct Drawing {
  std::vector<ClosedPath> outlines;  ///< as drawn, in the file's unit
  double unit = 0.0;                 ///< metres per unit, from $INSUNITS; 0: not given
};

/// Joins edges whose ends lie within 1e-6 of the drawing's size. Throws FileError: foreign for a
/// text that is not an ASCII DXF; corrupt, with the line, for invalid pairs and entities, for edges
/// that do not close and for a drawing without outlines. Messages use `name` for the file.
[[nodiscard]] Drawing parse_dxf(const std::string& bytes, const std::filesystem::path& name);

/// Metres per unit for "m", "cm", "mm", "in", "ft"; 0 for any other name.
[[nodiscard]] double metres(const std::string& unit);

}  // namespace wheeltap::io
