// Files that hold closed outlines: drawings and tables of corners.
//
// A table has columns y and z (or the first two, without a header), one corner a row. Rings are
// apart by an empty line, or by the values of a column "part". A header may name the unit:
// "y [mm]".
#pragma once

#include "io/drawings/dxf.hpp"

namespace wheeltap::io {

/// Reads a DXF by its ending, else a delimited text. Throws FileError.
[[nodiscard]] Drawing read_outlines(const std::filesystem::path& path);

/// Throws FileError (corrupt) for cells that are no numbers, rows that are too short, units that
/// are not known or differ between y and z.
[[nodiscard]] Drawing parse_outline_table(const std::string& bytes,
                                          const std::filesystem::path& name);

}  // namespace wheeltap::io
