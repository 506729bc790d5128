// MATLAB files, through libmatio.
#pragma once

#include <filesystem>

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Reads the numeric arrays of a MATLAB file (v5; v4 and v7.3 as libmatio can) as columns
/// (io/tables/array_columns.hpp). Fields of structures are "s.field" and "run(2).acc", cells
/// "runs{2}"; a complex "H" is "H, real" and "H, imaginary". Objects (tables, datetimes), which
/// libmatio cannot read, are among the table's `others` with what to do. From a path only: libmatio
/// does not read from memory; in a process of its own (`read_apart`), since some damaged files
/// crash it, or HDF5. Throws FileError: missing where the file cannot be read, or the library was
/// built without libmatio; corrupt where it holds no numeric arrays, is cut off, or has one that
/// cannot be read.
[[nodiscard]] Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted = {},
                                       const ArrayLayout& layout = {});

}  // namespace wheeltap::io
