// The formats of files that hold a table of numbers.
//
// To add one: a file with its parser, a line in the list of formats.cpp, and a test.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/tables/array_columns.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::io {

struct Format {
  std::string_view name;                  ///< in messages
  std::vector<std::string_view> endings;  ///< of file names, in lower case: ".csv"; "" is none
  std::vector<std::string_view> magic{};  ///< what such files begin with, if anything
  /// The table that these bytes are; `name` stands for the file in messages. Throws FileError.
  Columns (*parse)(std::string bytes, const std::filesystem::path& name,
                   const Wanted& wanted) = nullptr;
  /// In place of `parse`, where the layout of a text may be stated.
  Columns (*parse_text)(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                        const TextLayout& stated) = nullptr;
  /// In place of `parse`, where the library that reads the format needs a path.
  Columns (*read)(const std::filesystem::path& path, const Wanted& wanted,
                  const ArrayLayout& stated) = nullptr;
  /// In place of `parse`, of arrays.
  Columns (*parse_arrays)(std::string bytes, const std::filesystem::path& name,
                          const Wanted& wanted, const ArrayLayout& stated) = nullptr;
};

/// All that we know.
[[nodiscard]] std::span<const Format> formats();

/// The format of a file: by how it begins, then by its name's ending. Throws FileError (foreign),
/// naming those there are, for an ending that none has.
[[nodiscard]] const Format& format_of(const std::filesystem::path& path, std::string_view beginning,
                                      std::span<const Format> known = formats());

/// Reads a file of any of these formats. Throws FileError; also where a layout is stated of a file
/// that is no delimited text, or of arrays of one that holds none.
[[nodiscard]] Columns read_columns(const std::filesystem::path& path, const Wanted& wanted = {},
                                   std::span<const Format> known = formats(),
                                   const TextLayout& stated = {}, const ArrayLayout& arrays = {});

}  // namespace wheeltap::io
