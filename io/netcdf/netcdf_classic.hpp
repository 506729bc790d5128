// The required length of a NetCDF file of the classic formats.
#pragma once

#include <cstdint>
#include <istream>
#include <optional>

namespace wheeltap::io {

/// The number of bytes up to the last value of a classic NetCDF file (CDF-1, CDF-2 with offsets of
/// 64 bits, CDF-5), from its header; 0 for other formats, none if the header is truncated or
/// invalid. Without this check the NetCDF library silently reads zeros beyond the end of a
/// truncated file, and some damaged headers crash it.
///
/// A variable of fixed size ends at begin + its values. A variable of numrecs records ends at begin
/// + (numrecs - 1) Σ vsize + its values of one record, with the vsize of all record variables
/// (NetCDF Classic and 64-bit Offset File Formats, Unidata, "Computing File Offsets"). Files still
/// being streamed (numrecs = -1) are invalid here, because the library takes that as 2³² - 1
/// records.
[[nodiscard]] std::optional<std::uintmax_t> netcdf_classic_size(std::istream& file);

}  // namespace wheeltap::io
