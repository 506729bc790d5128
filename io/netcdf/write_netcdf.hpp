// Writing of a complete NetCDF-4 file: after an error, the previous file remains.
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
/// size of the file. The content of the file does not depend on the method: in memory or by a child
/// process. The child process has only the calling thread (read_apart.hpp). Throws FileError
/// (unwritable).
void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill);

}  // namespace wheeltap::io
