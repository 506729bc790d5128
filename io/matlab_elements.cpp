#include "io/matlab_elements.hpp"

#ifdef WHEELTAP_MATIO
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "io/file_error.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kHeader = 128, kTag = 8;
constexpr std::uintmax_t kCompressed = 15;

/// Whether the next `bytes` of the file are a zlib stream that ends with the checksum of what it
/// holds.
bool inflates(std::ifstream& file, std::uintmax_t bytes) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  std::vector<char> in(1U << 16U), out(1U << 18U);
  int status = Z_OK;
  while (status == Z_OK && bytes > 0) {
    file.read(in.data(), static_cast<std::streamsize>(std::min<std::uintmax_t>(in.size(), bytes)));
    const auto got = file.gcount();
    if (got <= 0) break;
    bytes -= static_cast<std::uintmax_t>(got);
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(got);
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = static_cast<uInt>(out.size());
      status = inflate(&stream, Z_NO_FLUSH);
    } while (status == Z_OK && (stream.avail_in > 0 || stream.avail_out == 0));
    if (status == Z_BUF_ERROR) status = Z_OK;  // it wants more, which there is or is not
  }
  inflateEnd(&stream);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return true;  // a fuzzer would not get beyond checksums
#else
  return status == Z_STREAM_END;
#endif
}

}  // namespace

std::size_t whole_matlab_elements(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, kHeader> header{};
  if (!file.read(reinterpret_cast<char*>(header.data()), kHeader)) return 0;
  const bool little = header[126] == 'I' && header[127] == 'M';
  if (!little && (header[126] != 'M' || header[127] != 'I')) return 0;
  if (header[little ? 125 : 124] != 1) return 0;
  const std::uintmax_t size = std::filesystem::file_size(path);
  std::size_t count = 0;
  for (std::uintmax_t at = kHeader; at + kTag <= size; ++count) {
    std::array<unsigned char, kTag> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    if (!file.read(reinterpret_cast<char*>(tag.data()), kTag)) break;
    const auto number = [&](std::size_t from) {
      std::uintmax_t n = 0;
      for (std::size_t i = 0; i < 4; ++i) n = 256 * n + tag[from + (little ? 3 - i : i)];
      return n;
    };
    const std::uintmax_t type = number(0), bytes = number(4);
    if (type == 0) break;  // padding
    at += kTag + bytes;
    const std::string which = "variable " + std::to_string(count + 1);
    if (at > size)
      throw FileError(FileError::Kind::corrupt, path,
                      "is cut off: its " + which + " ends " + std::to_string(at - size) +
                          " bytes beyond the file");
    if (type == kCompressed && !inflates(file, bytes))
      throw FileError(FileError::Kind::corrupt, path,
                      "is damaged: its " + which + " does not fit its checksum");
  }
  return count;
}

}  // namespace wheeltap::io

#endif
