// Atomic writing of files: a partly written file never has the final name.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/file_error.hpp"

namespace wheeltap::io {

/// A temporary file in the directory of `path`: "NAME.part" and 16 random hexadecimal digits,
/// created exclusively and locked for the lifetime of this object. `commit` renames the temporary
/// file to `path`. The destructor removes a temporary file that was not committed. If the process
/// is killed, the temporary file remains without its lock; the next AtomicFile for the same `path`
/// removes it.
class AtomicFile {
 public:
  /// Reserves `reserve` bytes on the disk. Throws FileError (unwritable) if no file can be created
  /// in the directory of `path`, or if the disk has too little space. Also throws FileError
  /// (unwritable) if `path` exists and is not a regular file (a folder, a pipe, a device).
  explicit AtomicFile(std::filesystem::path path, std::size_t reserve = 0);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Replaces the content of the temporary file by `bytes`. Throws FileError (unwritable).
  void write(std::string_view bytes);
  /// Appends `bytes` to the content of the temporary file. Throws FileError (unwritable).
  void append(std::string_view bytes);
  /// Calls `use` with the path of the temporary file. During the call, `use` may open the file for
  /// reading or writing, and may lock the file.
  void lend(const std::function<void(const std::filesystem::path& temporary)>& use);
  /// Writes the buffered content of the temporary file to the disk. Throws FileError (unwritable).
  void flush();
  /// Flushes the temporary file and renames it to `path`. Throws FileError (unwritable).
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

/// Renames the temporary files of one folder to their final names, all or none. If one rename
/// fails, this function restores the previous files. If the process is killed between two renames,
/// or cannot restore the files, a file with the remaining steps (kCommitNote) stays in the folder.
/// `finish_commit` completes these steps. Throws FileError (unwritable).
void commit_together(std::span<AtomicFile* const> files);

/// Completes an interrupted `commit_together` in this folder, if there is one.
void finish_commit(const std::filesystem::path& folder);

inline constexpr const char* kCommitNote = ".wheeltap-commit";

}  // namespace wheeltap::io
