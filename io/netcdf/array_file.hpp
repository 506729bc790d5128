// Measured records in NetCDF (classic, 64-bit, 4) and HDF5 files.
#pragma once

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Reads the numeric variables of the file and its groups ("group/name") as columns
/// (io/tables/array_columns.hpp); single numbers are scalars. A compound "H" of two real numbers is
/// a complex number and becomes "H, real" and "H, imaginary". The attribute "units" gives the unit
/// of a column. Values that equal the attribute "_FillValue" or "missing_value" become NaN. The
/// attributes "scale_factor" and "add_offset" are applied. Variables of other types are listed in
/// the table's `others`. Throws FileError: missing, corrupt, and foreign for a file without a
/// vector of two or more numbers.
[[nodiscard]] Columns read_array_file(const std::filesystem::path& path, const Wanted& wanted,
                                      const ArrayLayout& layout = {});

}  // namespace wheeltap::io
