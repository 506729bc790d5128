// Check that an HDF5 file contains all its data. The HDF5 library follows references to other
// files. A record from an untrusted source could therefore expose any file that the user may read.
#pragma once

#include <filesystem>
#include <string_view>

namespace wheeltap::io {

/// Throws FileError (corrupt) for an HDF5 file (of MATLAB v7.3, NetCDF-4 or any other program) with
/// a dataset in external storage, a virtual dataset, or a link to another file. Does nothing for
/// other formats and for files that HDF5 cannot open; the function that then reads the file reports
/// an error. In multi-threaded programs the caller must hold the NetcdfLock.
void require_own_storage(const std::filesystem::path& path);
/// Makes the same check for a file in memory; messages use `name` for the file.
void require_own_storage(std::string_view bytes, const std::filesystem::path& name);

}  // namespace wheeltap::io
