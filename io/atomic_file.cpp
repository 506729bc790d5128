#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <random>
#include <system_error>

namespace wheeltap::io {
namespace {

constexpr int kTries = 100;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw FileError(FileError::Kind::unwritable, path, reason);
}

/// Until what was written is on the disk, not only in the system's memory: after a power cut a file
/// that was renamed sooner may be there and empty.
int sync(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code none;
  const auto there = std::filesystem::status(path_, none);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
    fail(path_, std::filesystem::is_directory(there)
                    ? "is a directory"
                    : "is no regular file: a pipe or a device cannot be replaced");
  // A name that nobody else can have made, or guess: the folder may be everyone's.
  std::random_device random;
  int error = EEXIST;
  for (int i = 0; i < kTries && error == EEXIST; ++i) {
    char digits[20];
    std::snprintf(digits, sizeof digits, "%08x%08x", random(), random());
    temporary_ = path_;
    temporary_ += std::string(".part") + digits;
    const int descriptor =
        ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    error = descriptor < 0 ? errno : 0;
    if (descriptor >= 0) ::close(descriptor);
  }
  if (error != 0)
    fail(path_, "cannot be created: check that its directory exists and may be written to");
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  if (const int error = sync(temporary_, O_RDONLY); error != 0)
    fail(path_, std::generic_category().message(error));
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  if (error) fail(path_, error.message());
  committed_ = true;
  // The new name, too. A folder that may be written to need not be readable, and not every file
  // system knows how: the file is whole either way.
  const auto folder = path_.parent_path();
  static_cast<void>(sync(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY));
}

}  // namespace wheeltap::io
