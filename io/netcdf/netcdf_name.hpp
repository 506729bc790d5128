// Valid names of variables in NetCDF files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Returns the reason why a string is not a valid name of a variable (or the first part of a
/// name). The reason completes a sentence: "must begin with a letter, a digit or _". Returns
/// std::nullopt for a valid string. The rules are those of NC_check_name (NetCDF-C,
/// libdispatch/dstring.c), except that some of the 256 allowed bytes are reserved for prefixes and
/// suffixes.
[[nodiscard]] std::optional<std::string> netcdf_name_error(std::string_view name);

/// Converts a string to a valid name: each invalid character becomes _.
[[nodiscard]] std::string netcdf_name(std::string_view name);

}  // namespace wheeltap::io
