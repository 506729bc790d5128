// Measured records in NetCDF (classic, 64-bit, 4) and HDF5 files.
#pragma once

#include "io/columns.hpp"

namespace wheeltap::io {

/// The numeric variables of the file, of its groups too ("group/name"): vectors of one length are
/// the columns, of several lengths those that most numbers have (the longer ones where as many);
/// a matrix is a column for each number behind its first dimension, "name(:,2)", unless its second
/// dimension is that length: then for each row, "name(2,:)". Single numbers are the scalars. The
/// attribute "units" gives a column's unit, "_FillValue" and "missing_value" are NaN,
/// "scale_factor" and "add_offset" are applied. Throws FileError: missing, corrupt, and foreign for
/// a file that holds no vector of two numbers or more.
[[nodiscard]] Columns read_array_file(const std::filesystem::path& path, const Wanted& wanted);

}  // namespace wheeltap::io
