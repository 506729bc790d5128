// NumPy arrays in .npy files, and in .npz files (ZIP archives of .npy files).
#pragma once

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Reads an array written by numpy.save (NumPy Enhancement Proposal 1): versions 1 to 3 of the
/// format. Elements are booleans, integers, real or complex numbers in either byte order; the array
/// is in C or Fortran order. The array's name is the file name without its extension.
/// io/tables/array_columns.hpp describes the columns. Throws FileError (foreign) if the file does
/// not begin with the first bytes of the format. Throws FileError (corrupt), with a remedy, if the
/// file is truncated or invalid, and for arrays of objects or of a structured type.
[[nodiscard]] Columns parse_npy(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

/// Reads the arrays of an archive written by numpy.savez or savez_compressed. Arrays of objects or
/// strings are listed in the table's `others`.
[[nodiscard]] Columns parse_npz(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

}  // namespace wheeltap::io
