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
/// without a commit it is removed. A killed process leaves its temporary file behind, unlocked. The
/// next AtomicFile for the same `path` removes it.
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
  /// `use` may open the temporary file by its name, for reading or writing, with its own locks.
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
/// are restored. A process that is killed in between, or that cannot restore them, leaves a note of
/// the remaining steps (kCommitNote), which `finish_commit` completes. Throws FileError
/// (unwritable).
void commit_together(std::span<AtomicFile* const> files);

/// Completes an interrupted `commit_together` in this folder, if there is one.
void finish_commit(const std::filesystem::path& folder);

inline constexpr const char* kCommitNote = ".wheeltap-commit";

}  // namespace wheeltap::io
