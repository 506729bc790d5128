// File formats that hold a table of numbers.
//
// To add a format, write a file with its parser, a line in the list of formats.cpp, and a test.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

struct Format {
  std::string_view name;                  ///< name in messages
  std::vector<std::string_view> endings;  ///< file extensions, in lower case: ".csv"; "" is none
  std::vector<std::string_view> magic{};  ///< possible first bytes of such files, if fixed
  /// Parses the bytes as a table; messages use `name` for the file. Throws FileError.
  Columns (*parse)(std::string bytes, const std::filesystem::path& name,
                   const Wanted& wanted) = nullptr;
  /// Used instead of `parse` if the caller may state the layout of a text.
  Columns (*parse_text)(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                        const TextLayout& stated) = nullptr;
  /// Used instead of `parse` if the library that reads the format needs a path.
  Columns (*read)(const std::filesystem::path& path, const Wanted& wanted,
                  const ArrayLayout& stated) = nullptr;
  /// Used instead of `parse` for arrays.
  Columns (*parse_arrays)(std::string bytes, const std::filesystem::path& name,
                          const Wanted& wanted, const ArrayLayout& stated) = nullptr;
};

/// All supported formats.
[[nodiscard]] std::span<const Format> formats();

/// Finds the format of a file from its first bytes, then from its extension. Throws FileError
/// (foreign) with the list of known extensions if neither matches.
[[nodiscard]] const Format& format_of(const std::filesystem::path& path, std::string_view beginning,
                                      std::span<const Format> known = formats());

/// Reads a file of any of these formats. Throws FileError, also if a text layout is given for a
/// file that is not delimited text, or array options for a file without arrays.
[[nodiscard]] Columns read_columns(const std::filesystem::path& path, const Wanted& wanted = {},
                                   std::span<const Format> known = formats(),
                                   const TextLayout& stated = {}, const ArrayLayout& arrays = {});

}  // namespace wheeltap::io
