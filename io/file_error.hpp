// Why a file could not be used.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace wheeltap::io {

/// A file that could not be read or written, and why.
class FileError : public std::runtime_error {
 public:
  enum class Kind {
    missing,     ///< not there, or not readable
    corrupt,     ///< truncated, damaged, or contradicting itself
    foreign,     ///< another program's file, or not a file of this sort at all
    version,     ///< a format of another version of this program
    mismatch,    ///< made for something else (its fingerprint differs)
    incomplete,  ///< a table of which some runs are not done yet
    unwritable   ///< cannot be created there
  };
  FileError(Kind kind, std::filesystem::path path, std::string reason)
      : std::runtime_error(path.string() + ": " + reason),
        kind_(kind),
        path_(std::move(path)),
        reason_(std::move(reason)) {}
  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  Kind kind_;
  std::filesystem::path path_;
  std::string reason_;
};

}  // namespace wheeltap::io
