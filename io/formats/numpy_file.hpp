// NumPy arrays: .npy, and .npz, a ZIP archive of them.
#pragma once

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Reads an array written by numpy.save (NumPy Enhancement Proposal 1): versions 1 to 3; booleans,
/// integers, real and complex numbers of either byte order, in C or Fortran order. The array's name
/// is the file name without its extension. io/tables/array_columns.hpp describes the columns.
/// Throws FileError: foreign if the first bytes are not those of the format; corrupt, with a
/// remedy, for a truncated or damaged file, and for arrays of objects or of a structured type.
[[nodiscard]] Columns parse_npy(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

/// Reads the arrays of an archive written by numpy.savez or savez_compressed. Arrays of objects or
/// texts are listed in the table's `others`.
[[nodiscard]] Columns parse_npz(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

}  // namespace wheeltap::io
