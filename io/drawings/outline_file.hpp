// Reads closed outlines from files: drawings and tables of corners.
//
// A table has columns y and z (or the first two columns if there is no header), one corner per row.
// Rings are separated by an empty line or by the values of a column "part". A header may name the
// unit: "y [mm]".
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
