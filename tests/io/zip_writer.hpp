// Small ZIP archives for tests.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wheeltap::test {

inline std::string little_endian(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i, value >>= 8) out += static_cast<char>(value & 0xFFU);
  return out;
}

inline std::string deflated(const std::string& data) {
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string in = data, out(data.size() + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

inline std::string zip(const std::vector<std::pair<std::string, std::string>>& members,
                       bool packed = false) {
  std::string out, directory;
  for (const auto& [name, data] : members) {
    const std::string body = packed ? deflated(data) : data;
    const auto checksum =
        crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size()));
    const std::string shared = little_endian(0, 2) + little_endian(packed ? 8 : 0, 2) +
                               little_endian(0, 4) + little_endian(checksum, 4) +
                               little_endian(body.size(), 4) + little_endian(data.size(), 4) +
                               little_endian(name.size(), 2) + little_endian(0, 2);
    directory += "PK\1\2" + little_endian(20, 2) + little_endian(20, 2) + shared +
                 little_endian(0, 10) + little_endian(out.size(), 4) + name;
    out += "PK\3\4" + little_endian(20, 2) + shared + name + body;
  }
  const std::size_t at = out.size();
  return out + directory + "PK\5\6" + little_endian(0, 4) + little_endian(members.size(), 2) +
         little_endian(members.size(), 2) + little_endian(directory.size(), 4) +
         little_endian(at, 4) + little_endian(0, 2);
}

}  // namespace wheeltap::test
