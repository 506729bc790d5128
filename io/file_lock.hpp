// Locking of a file or folder for one process.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace wheeltap::io {

/// An advisory lock (flock) on an existing file or folder. The lock needs no lock file, and ends
/// with the FileLock object or the process. For files that cannot be read, and on file systems
/// without locks, the FileLock object is valid but holds no lock.
class FileLock {
 public:
  /// Locks the file or folder. Returns std::nullopt if another process, or another object of this
  /// process, holds the lock during the whole waiting time `patience`. Waiting is useful, because a
  /// killed process may need a moment to release its lock. Throws FileError (missing).
  [[nodiscard]] static std::optional<FileLock> take(
      const std::filesystem::path& path,
      std::chrono::milliseconds patience = std::chrono::milliseconds(0));

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace wheeltap::io
