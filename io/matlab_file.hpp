// MATLAB files, through libmatio.
#pragma once

#include <filesystem>

#include "io/columns.hpp"

namespace wheeltap::io {

/// Reads the numeric arrays of a MATLAB file (v5; v4 and v7.3 as libmatio can). A vector is one
/// column under its name, a matrix "X1" the columns "X1(:,1)", "X1(:,2)", …, or, where its rows are
/// longer, "X1(1,:)", "X1(2,:)", …, and a field of a structure "s.field"; a complex "H" is the
/// columns "H, real" and "H, imaginary". Columns have the length that most numbers have, or the one
/// of more of the columns that are wanted; arrays of other lengths are left out. Single numbers are
/// scalars. From a path only: libmatio does not read from memory; in a process of its own
/// (`read_apart`), since some damaged files crash it, or HDF5. Throws FileError: missing where the
/// file cannot be read, or the library was built without libmatio; corrupt where it holds no real
/// numeric arrays, is cut off, or has one that cannot be read.
[[nodiscard]] Columns read_matlab_file(const std::filesystem::path& path,
                                       const Wanted& wanted = {});

}  // namespace wheeltap::io
