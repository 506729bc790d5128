// A NetCDF-4 file that is written whole or not at all.
#pragma once

#include <cstddef>
#include <functional>

#include "io/atomic_file.hpp"

namespace wheeltap::io {

class NetcdfWriter;

/// Puts groups and variables into a file.
using FillNetcdf = std::function<void(const NetcdfWriter&)>;

/// Files to hold about this much are written in memory and from there, longer ones on the disk as
/// they are filled: by a child process, since HDF5 ends its own where the disk is full.
constexpr std::size_t kNetcdfInMemory = std::size_t{64} << 20U;

/// Writes what `fill` puts into it, about so many bytes, in place of what was written before, and
/// the same either way. A child writes it with this one thread (read_apart.hpp). Throws FileError
/// (unwritable).
void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill);

}  // namespace wheeltap::io
