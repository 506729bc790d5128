// The file formats from which Wheeltap reads a table of numbers.
// To add a format, write a source file with the parser of the format, add a line to the list in
// formats.cpp, and write a test.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

struct Format {
  std::string_view name;                  ///< name of the format in messages
  std::vector<std::string_view> endings;  ///< file extensions, in lower case: ".csv"; "" is none
  std::vector<std::string_view> magic{};  ///< possible first bytes; empty if they are not fixed
  /// Parses the bytes as a table; messages use `name` for the file. Throws FileError.
  Columns (*parse)(std::string bytes, const std::filesystem::path& name,
                   const Wanted& wanted) = nullptr;
  /// Parser for text formats, used instead of `parse`. The caller may state the layout of the text.
  Columns (*parse_text)(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                        const TextLayout& stated) = nullptr;
  /// Reader for formats whose library needs a path; used instead of `parse`.
  Columns (*read)(const std::filesystem::path& path, const Wanted& wanted,
                  const ArrayLayout& stated) = nullptr;
  /// Parser for formats that store arrays; used instead of `parse`.
  Columns (*parse_arrays)(std::string bytes, const std::filesystem::path& name,
                          const Wanted& wanted, const ArrayLayout& stated) = nullptr;
};

/// All supported formats.
[[nodiscard]] std::span<const Format> formats();

/// Finds the format of a file from its first bytes (`beginning`) or, if these are not known, from
/// its extension. Throws FileError (foreign), with the list of known extensions, if no format
/// matches the bytes or the extension.
[[nodiscard]] const Format& format_of(const std::filesystem::path& path, std::string_view beginning,
                                      std::span<const Format> known = formats());

/// Reads a file in any format of the list `known`. Throws FileError for a file that cannot be read.
/// Also throws FileError if the caller states a text layout for a file that is not delimited text,
/// or array options for a file without arrays.
[[nodiscard]] Columns read_columns(const std::filesystem::path& path, const Wanted& wanted = {},
                                   std::span<const Format> known = formats(),
                                   const TextLayout& stated = {}, const ArrayLayout& arrays = {});

}  // namespace wheeltap::io
