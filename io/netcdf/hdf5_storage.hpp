// Checks that an HDF5 file contains its own data. The library follows references to other files, so
// a record from an untrusted source could expose any file that its reader may read.
#pragma once

#include <filesystem>
#include <string_view>

namespace wheeltap::io {

/// Throws FileError (corrupt) for an HDF5 file (of MATLAB v7.3, NetCDF-4 or any other program) with
/// a dataset in external storage, a virtual dataset, or a link to another file. Does nothing for
/// other formats and for files that HDF5 cannot open; their reader reports those. In multi-threaded
/// programs the caller must hold the NetcdfLock.
void require_own_storage(const std::filesystem::path& path);
/// The same check for a file in memory; messages use `name`.
void require_own_storage(std::string_view bytes, const std::filesystem::path& name);

}  // namespace wheeltap::io
