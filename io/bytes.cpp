#include "io/bytes.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>

#include "io/file_error.hpp"

namespace wheeltap::io {

std::string first_bytes(const std::filesystem::path& path, std::size_t most) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  const auto fail = [&] {
    throw FileError(FileError::Kind::missing, path, "no such file, or it cannot be read");
  };
  if (!file) fail();
  // A whole file in one go; what has no size, such as a pipe, in pieces.
  std::error_code unknown;
  const auto stated = std::filesystem::file_size(path, unknown);
  std::string bytes;
  std::size_t size = 0;
  for (std::size_t piece = unknown ? 65536 : static_cast<std::size_t>(stated) + 1; size < most;
       piece = 65536) {
    bytes.resize(size + std::min(piece, most - size));
    const std::size_t got = std::fread(bytes.data() + size, 1, bytes.size() - size, file.get());
    size += got;
    if (size < bytes.size()) break;
  }
  if (std::ferror(file.get()) != 0) fail();  // a folder, too
  bytes.resize(size);
  return bytes;
}

std::string read_bytes(const std::filesystem::path& path) {
  return first_bytes(path, std::numeric_limits<std::size_t>::max());
}

}  // namespace wheeltap::io
