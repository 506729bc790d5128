// A file or folder held by one process.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace wheeltap::io {

/// An advisory lock (flock) on a file or folder that is there. It leaves nothing behind and ends
/// with its object, or with the process however that ends. What cannot be read, or lies on a file
/// system without locks, gives one that holds nothing.
class FileLock {
 public:
  /// Nothing where another process, or another object of this one, holds it for as long as
  /// `patience`: one that was killed may need a moment to end. Throws FileError (missing).
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
