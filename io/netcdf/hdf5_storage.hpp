// Whether an HDF5 file holds its numbers itself. The library follows a file's word for where they
// are: a record of someone else's could name any file that its reader may read.
#pragma once

#include <filesystem>
#include <string_view>

namespace wheeltap::io {

/// Throws FileError (corrupt) for an HDF5 file (of MATLAB v7.3, NetCDF-4 or any other program) with
/// a dataset in external storage, a virtual dataset, or a link to another file. Does nothing for
/// other formats, and for a file that HDF5 cannot open, which its reader says. The caller holds the
/// NetcdfLock where there are threads.
void require_own_storage(const std::filesystem::path& path);
/// The same of a file in memory; `name` stands for it in messages.
void require_own_storage(std::string_view bytes, const std::filesystem::path& name);

}  // namespace wheeltap::io
