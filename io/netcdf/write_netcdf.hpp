// Writes a NetCDF-4 file completely or not at all.
#pragma once

#include <cstddef>
#include <functional>

#include "io/atomic_file.hpp"

namespace wheeltap::io {

class NetcdfWriter;

/// Writes groups and variables into a file.
using FillNetcdf = std::function<void(const NetcdfWriter&)>;

/// Limit of the expected size: smaller files are built in memory, larger ones on the disk by a
/// child process, because HDF5 ends its process if the disk is full.
constexpr std::size_t kNetcdfInMemory = std::size_t{64} << 20U;

/// Writes the content from `fill`, of about this many bytes, and replaces the previous file. Both
/// methods give the same bytes. A child writes with this one thread (read_apart.hpp). Throws
/// FileError (unwritable).
void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill);

}  // namespace wheeltap::io
