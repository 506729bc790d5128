// The required length of a NetCDF file of the classic formats.
#pragma once

#include <cstdint>
#include <istream>
#include <optional>

namespace wheeltap::io {

/// From the header of a NetCDF file of a classic format (CDF-1, CDF-2 with 64-bit offsets, CDF-5),
/// computes the number of bytes of the complete file up to its last value. The result is 0 for
/// other formats, and std::nullopt if the header is truncated or invalid. Without this check of the
/// length, the NetCDF library silently reads zeros beyond the end of a truncated file, and some
/// corrupt headers cause the library to crash.
///
/// A variable of fixed size ends at begin plus the size of its values. A variable with numrecs
/// records ends at begin + (numrecs - 1) Σ vsize plus the size of the variable's values in one
/// record. The sum Σ is over all record variables (NetCDF Classic and 64-bit Offset File Formats,
/// Unidata, "Computing File Offsets"). A file that another program is still writing (numrecs = -1)
/// is invalid, because the NetCDF library would read 2³² - 1 records.
[[nodiscard]] std::optional<std::uintmax_t> netcdf_classic_size(std::istream& file);

}  // namespace wheeltap::io
