// What a variable of a NetCDF file may be called.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Why a variable, or the beginning of one's name, cannot be called so, as the end of a sentence:
/// "must begin with a letter, a digit or _"; none where it can. The rules are those of
/// NC_check_name (NetCDF-C, libdispatch/dstring.c), with some of the 256 bytes left for what is put
/// about a name.
[[nodiscard]] std::optional<std::string> why_no_netcdf_name(std::string_view name);

/// The nearest name that it can have: other characters become _.
[[nodiscard]] std::string netcdf_name(std::string_view name);

}  // namespace wheeltap::io
