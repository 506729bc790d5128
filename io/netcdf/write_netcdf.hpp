// Writing of a complete NetCDF-4 file. If writing fails, the previous file remains unchanged.
#pragma once

#include <cstddef>
#include <functional>

#include "io/atomic_file.hpp"

namespace wheeltap::io {

class NetcdfWriter;

/// A function that writes groups and variables into a file.
using FillNetcdf = std::function<void(const NetcdfWriter&)>;

/// Largest expected size of a file that is built in memory [bytes]. A child process builds larger
/// files on the disk, because HDF5 terminates its process if the disk is full.
constexpr std::size_t kNetcdfInMemory = std::size_t{64} << 20U;

/// Writes the content that `fill` produces, and replaces the previous file. `bytes` is the expected
/// size of the file. A file built in memory and a file built by a child process have the same
/// content. The child process contains only the calling thread (read_apart.hpp). Throws FileError
/// (unwritable).
void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill);

}  // namespace wheeltap::io
