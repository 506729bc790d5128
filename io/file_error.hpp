// Errors of reading and writing files, with the position in the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace wheeltap::io {

/// A position in a file. Line and column numbers start at 1, row numbers at 0. Unknown members are
/// 0, negative or an empty string.
struct Place {
  std::ptrdiff_t line = 0;
  std::ptrdiff_t sample = -1;  ///< row number in a file without lines
  std::ptrdiff_t column = 0;
  std::string header = {};  ///< name of the column

  /// The position as text that follows the file's name in messages: ", line 3, column 2 ('force
  /// [N]')".
  [[nodiscard]] std::string text() const {
    std::string out;
    if (line > 0) out += ", line " + std::to_string(line);
    if (sample >= 0) out += ", sample " + std::to_string(sample);
    if (column > 0) out += ", column " + std::to_string(column);
    if (!header.empty()) out += " ('" + header + "')";
    return out;
  }
};

/// A file that could not be read or written: "FILE, line 3, column 2 ('force [N]'): REASON".
class FileError : public std::runtime_error {
 public:
  enum class Kind {
    missing,     ///< the file does not exist or cannot be read
    corrupt,     ///< truncated, invalid, or inconsistent
    foreign,     ///< file of another program or another format
    version,     ///< format of another version of this program
    mismatch,    ///< file of another case: the fingerprints differ
    incomplete,  ///< a table with missing runs
    unwritable   ///< the file cannot be created or written
  };
  FileError(Kind kind, std::filesystem::path path, std::string reason)
      : FileError(kind, std::move(path), {}, std::move(reason)) {}
  FileError(Kind kind, std::filesystem::path path, Place place, std::string reason)
      : std::runtime_error(path.string() + place.text() + ": " + reason),
        kind_(kind),
        path_(std::move(path)),
        place_(std::move(place)),
        reason_(std::move(reason)) {}
  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const Place& place() const { return place_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  Kind kind_;
  std::filesystem::path path_;
  Place place_;
  std::string reason_;
};

/// The error for a requested column that does not exist in a file, or exists more than once.
class NoSuchColumn : public FileError {
 public:
  NoSuchColumn(std::filesystem::path path, std::string column, std::string reason)
      : FileError(Kind::corrupt, std::move(path), std::move(reason)), column_(std::move(column)) {}
  [[nodiscard]] const std::string& column() const { return column_; }

 private:
  std::string column_;
};

}  // namespace wheeltap::io
