// Reading of MATLAB files with the library libmatio.
#pragma once

#include <filesystem>

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Reads the numeric arrays of a MATLAB file (v5; v4 and v7.3 as far as libmatio supports them) as
/// columns (io/tables/array_columns.hpp). Columns are called "s.field" or "run(2).acc" for fields
/// of structures, "runs{2}" for elements of cell arrays. A complex array "H" becomes the columns
/// "H, real" and "H, imaginary". libmatio cannot read objects (tables, datetimes); `others` of the
/// result lists the objects, each with a remedy. The argument is a path, because libmatio cannot
/// read from memory. A child process reads the file (`read_apart`), because some corrupt files
/// crash libmatio or HDF5. Throws FileError: missing if the file cannot be read, or the library was
/// built without libmatio; corrupt if the file has no numeric arrays, is truncated, or contains an
/// array that cannot be read.
[[nodiscard]] Columns read_matlab_file(const std::filesystem::path& path, const Wanted& wanted = {},
                                       const ArrayLayout& layout = {});

}  // namespace wheeltap::io
