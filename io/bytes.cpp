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

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "is a directory";
  if (S_ISFIFO(mode)) return "is a pipe, not a file: store its content in a file first";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "is a device, not a file";
  return "is not a file";
}

/// An open regular file. The destructor closes the file.
class OpenFile {
 public:
  /// Throws FileError (missing).
  explicit OpenFile(const std::filesystem::path& path)
      // Without O_NONBLOCK, opening a pipe would wait for a writer.
      : path_(path), id_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (id_ < 0 && errno == ENOENT) throw FileError(FileError::Kind::missing, path, "no such file");
    if (id_ < 0) fail(std::strerror(errno));
    struct stat status {};
    const int error = ::fstat(id_, &status) == 0 ? 0 : errno;
    if (error == 0 && S_ISREG(status.st_mode)) {
      size_ = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
      return;
    }
    ::close(id_);
    fail(error == 0 ? kind_of(status.st_mode) : std::strerror(error));
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(id_); }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Reads at most `most` bytes. Returns the number of bytes read, which is 0 at the end of the
  /// file.
  std::size_t read(char* to, std::size_t most) const {
    while (true) {
      const ssize_t n = ::read(id_, to, most);
      if (n >= 0) return static_cast<std::size_t>(n);
      if (errno != EINTR) fail(std::strerror(errno));
    }
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw FileError(FileError::Kind::missing, path_, "cannot be read: " + why);
  }

  const std::filesystem::path& path_;
  int id_;
  std::size_t size_ = 0;
};

}  // namespace

std::string first_bytes(const std::filesystem::path& path, std::size_t most, std::size_t largest) {
  const OpenFile file(path);
  if (std::min(file.size(), most) > largest) {
    throw FileError(
        FileError::Kind::corrupt, path,
        std::to_string(file.size()) + " bytes, must be at most " + std::to_string(largest));
  }
  std::string bytes(std::min(file.size(), most), '\0');
  std::size_t got = 0;
  while (got < bytes.size()) {
    const std::size_t n = file.read(bytes.data() + got, bytes.size() - got);
    if (n == 0) break;
    got += n;
  }
  bytes.resize(got);
  return bytes;
}

void each_piece(const std::filesystem::path& path,
                const std::function<void(std::string_view)>& take) {
  constexpr std::size_t kPiece = 1 << 20;
  const OpenFile file(path);
  std::string piece(kPiece, '\0');
  while (const std::size_t n = file.read(piece.data(), piece.size()))
    take(std::string_view(piece).substr(0, n));
}

std::string read_bytes(const std::filesystem::path& path, std::size_t largest) {
  return first_bytes(path, std::numeric_limits<std::size_t>::max(), largest);
}

}  // namespace wheeltap::io
