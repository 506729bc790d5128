// Reading of closed outlines from files: drawings and tables of corners.
// A table of corners has one corner per row. The coordinates are in the columns y and z, or in the
// first two columns if the table has no header. In a table with a column "part", each new value of
// this column begins a new outline. In other tables, an empty line separates two outlines. A column
// header may contain the unit of length: "y [mm]".
#pragma once

#include "io/drawings/dxf.hpp"

namespace wheeltap::io {

/// Reads a file whose name ends with .dxf as a DXF drawing, and any other file as delimited text.
/// Throws FileError.
[[nodiscard]] Drawing read_outlines(const std::filesystem::path& path);

/// Parses a table of corners. Throws FileError (corrupt) for cells that are not numbers, short
/// rows, unknown units, and different units of y and z.
[[nodiscard]] Drawing parse_outline_table(const std::string& bytes,
                                          const std::filesystem::path& name);

}  // namespace wheeltap::io
