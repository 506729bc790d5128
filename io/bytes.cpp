#include "io/bytes.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <limits>

#include "io/file_error.hpp"

namespace wheeltap::io {
namespace {

/// An open file, closed at the end of its scope.
class Descriptor {
 public:
  // Without O_NONBLOCK, opening a pipe waits for somebody to write into it.
  explicit Descriptor(const std::filesystem::path& path)
      : id_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (id_ >= 0) ::close(id_);
  }
  [[nodiscard]] int id() const { return id_; }

 private:
  int id_;
};

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "is a directory";
  if (S_ISFIFO(mode)) return "is a pipe, not a file: its content must be stored first";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "is a device, not a file";
  return "is not a file";
}

}  // namespace

std::string first_bytes(const std::filesystem::path& path, std::size_t most, std::size_t largest) {
  const auto fail = [&](const std::string& why) {
    throw FileError(FileError::Kind::missing, path, "cannot be read: " + why);
  };
  const Descriptor file(path);
  if (file.id() < 0 && errno == ENOENT)
    throw FileError(FileError::Kind::missing, path, "no such file");
  if (file.id() < 0) fail(std::strerror(errno));
  struct stat status {};
  if (::fstat(file.id(), &status) != 0) fail(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) fail(kind_of(status.st_mode));
  const auto size = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
  if (std::min(size, most) > largest) {
    throw FileError(FileError::Kind::corrupt, path,
                    std::to_string(size) + " bytes, must be at most " + std::to_string(largest));
  }
  std::string bytes(std::min(size, most), '\0');
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t n = ::read(file.id(), bytes.data() + got, bytes.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(std::strerror(errno));
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

std::string read_bytes(const std::filesystem::path& path, std::size_t largest) {
  return first_bytes(path, std::numeric_limits<std::size_t>::max(), largest);
}

}  // namespace wheeltap::io
