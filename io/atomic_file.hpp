// Writing a file so that nothing half-written ever stands under its name.
#pragma once

#include "io/file_error.hpp"

namespace wheeltap::io {

/// Holds a temporary name in the directory of `path`. What is written there takes `path`'s place at
/// `commit`, and is removed when it never comes to that.
class AtomicFile {
 public:
  /// Throws FileError (unwritable) where no file can be created there, or something else than a
  /// regular file has the name: a folder, a pipe, a device.
  explicit AtomicFile(std::filesystem::path path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Waits for the disk and renames; the file must be closed. Throws FileError (unwritable).
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  bool committed_ = false;
};

}  // namespace wheeltap::io
