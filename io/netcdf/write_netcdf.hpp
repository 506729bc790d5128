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

/// Writes the content that `fill` produces, of about `bytes` bytes, and replaces the previous file.
/// The file is the same whether it is built in memory or by a child process. The child process has
/// only the calling thread (read_apart.hpp). Throws FileError (unwritable).
void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill);

}  // namespace wheeltap::io
