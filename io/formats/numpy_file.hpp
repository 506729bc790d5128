// NumPy's arrays: .npy, and .npz, a ZIP archive of them.
#pragma once

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// An array as numpy.save writes it (NumPy Enhancement Proposal 1): versions 1 to 3; booleans,
/// integers, real and complex numbers of either byte order, of C or Fortran order. Its name is that
/// of the file without its ending. Columns as io/tables/array_columns.hpp has it. Throws FileError:
/// foreign for what does not begin as such a file, corrupt for one that is cut off, damaged, or
/// holds objects or a structured type, with what to do.
[[nodiscard]] Columns parse_npy(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

/// The same of the arrays of an archive as numpy.savez and savez_compressed write it; arrays of
/// objects or texts are among the table's `others`.
[[nodiscard]] Columns parse_npz(std::string bytes, const std::filesystem::path& name,
                                const Wanted& wanted, const ArrayLayout& stated);

}  // namespace wheeltap::io
