// Reads closed outlines from files: drawings and tables of corners.
//
// A table has columns y and z (or the first two columns if there is no header), one corner per row.
// Rings are separated by an empty line or by the values of a column "part". A header may name the
// unit: "y [mm]".
#pragma once

#include "io/drawings/dxf.hpp"

namespace wheeltap::io {

/// Reads a DXF if the file name ends with .dxf, otherwise a delimited text. Throws FileError.
[[nodiscard]] Drawing read_outlines(const std::filesystem::path& path);

/// Throws FileError (corrupt) for cells that are not numbers, short rows, unknown units, and units
/// that differ between y and z.
[[nodiscard]] Drawing parse_outline_table(const std::string& bytes,
                                          const std::filesystem::path& name);

}  // namespace wheeltap::io
