#include "io/atomic_file.hpp"

#include <unistd.h>

#include <atomic>
#include <fstream>

namespace wheeltap::io {

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  static std::atomic<int> counter = 0;  // two threads may write the same file
  temporary_ = path_;
  temporary_ += ".part" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  if (!std::ofstream(temporary_))
    throw FileError(FileError::Kind::unwritable, path_,
                    "cannot be created: check that its directory exists and may be written to");
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  if (error) throw FileError(FileError::Kind::unwritable, path_, error.message());
}

}  // namespace wheeltap::io
