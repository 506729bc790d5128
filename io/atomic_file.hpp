// Atomic file writing: no partly written file ever has the final name.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/file_error.hpp"

namespace wheeltap::io {

/// A temporary file in the directory of `path`: "NAME.part" and 16 random hexadecimal digits,
/// created exclusively and locked for the lifetime of this object. `commit` renames it to `path`;
/// without a commit it is removed. If the process is killed, the temporary file remains without its
/// lock; the next AtomicFile for the same `path` removes it.
class AtomicFile {
 public:
  /// Reserves `reserve` bytes. Throws FileError (unwritable) if no file can be created there, if
  /// the name belongs to something other than a regular file (a folder, a pipe, a device), or if
  /// there is not enough space.
  explicit AtomicFile(std::filesystem::path path, std::size_t reserve = 0);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Replaces the content written so far. Throws FileError (unwritable).
  void write(std::string_view bytes);
  /// Appends to the content. Throws FileError (unwritable).
  void append(std::string_view bytes);
  /// Calls `use` with the path of the temporary file. `use` may open the file for reading or
  /// writing and lock it itself.
  void lend(const std::function<void(const std::filesystem::path& temporary)>& use);
  /// Flushes to the disk. Throws FileError (unwritable).
  void flush();
  /// Flushes and renames. Throws FileError (unwritable).
  void commit();

 private:
  friend void commit_together(std::span<AtomicFile* const> files);
  void put(std::string_view bytes) const;
  void rename() const;
  void close();

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
  bool committed_ = false;
};

/// Renames the files of one folder together, all or none. If one rename fails, the previous files
/// are restored. If the process is killed between two renames, or cannot restore the files, a file
/// with the remaining steps (kCommitNote) is left; `finish_commit` completes them. Throws FileError
/// (unwritable).
void commit_together(std::span<AtomicFile* const> files);

/// Completes an interrupted `commit_together` in this folder, if there is one.
void finish_commit(const std::filesystem::path& folder);

inline constexpr const char* kCommitNote = ".wheeltap-commit";

}  // namespace wheeltap::io
