// How long a NetCDF file of the classic formats must be.
#pragma once

#include <cstdint>
#include <istream>
#include <optional>

namespace wheeltap::io {

/// The bytes up to the last value of a classic NetCDF file (CDF-1, CDF-2 with offsets of 64 bits,
/// CDF-5), from its header; 0 of other formats, none where the header is cut off or makes no sense.
/// The NetCDF library reads zeros where such a file ends too soon, and does not say so, and crashes
/// on some damaged headers.
///
/// A variable of fixed size ends at begin + its values; one of numrecs records at
/// begin + (numrecs - 1) Σ vsize + its values of one record, with the vsize of all record variables
/// (NetCDF Classic and 64-bit Offset File Formats, Unidata, "Computing File Offsets"). Records that
/// were still being streamed (numrecs = -1) make no sense here: the library takes them for 2³² - 1.
[[nodiscard]] std::optional<std::uintmax_t> netcdf_classic_size(std::istream& file);

}  // namespace wheeltap::io
