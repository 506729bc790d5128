// Valid names of variables in NetCDF files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Why a text cannot be the name of a variable, or its beginning, as the end of a sentence: "must
/// begin with a letter, a digit or _"; none if it is valid. The rules are those of NC_check_name
/// (NetCDF-C, libdispatch/dstring.c), with some of the 256 bytes reserved for prefixes and
/// suffixes.
[[nodiscard]] std::optional<std::string> netcdf_name_error(std::string_view name);

/// The nearest valid name: invalid characters become _.
[[nodiscard]] std::string netcdf_name(std::string_view name);

}  // namespace wheeltap::io
