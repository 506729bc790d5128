#include "io/matlab/matlab_elements.hpp"

#ifdef WHEELTAP_MATIO
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file_error.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kHeader = 128, kTag = 8;
constexpr std::uintmax_t kCompressed = 15;

constexpr std::size_t kHead = 512;  // bytes; flags and names of an object are shorter

/// True if the next `bytes` of the file are a zlib stream with a correct checksum; `head` receives
/// the first bytes of its content.
bool inflates(std::ifstream& file, std::uintmax_t bytes, std::string& head) {
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
      head.append(out.data(), std::min(kHead - head.size(), out.size() - stream.avail_out));
    } while (status == Z_OK && (stream.avail_in > 0 || stream.avail_out == 0));
    if (status == Z_BUF_ERROR) status = Z_OK;  // the loop provides more input
  }
  inflateEnd(&stream);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return true;  // a fuzzer would not get past checksums
#else
  return status == Z_STREAM_END;
#endif
}

/// Reads the first fields of a variable: flags, then texts.
class ElementFields {
 public:
  ElementFields(std::string_view bytes, bool little) : bytes_(bytes), little_(little) {}

  /// The data of the next field, which is padded to 8 bytes. Up to 4 data bytes are stored within
  /// the tag. Empty if truncated.
  std::string_view next() {
    if (bytes_.size() - at_ < kTag) return {};
    const std::uint64_t tag = number(at_), packed = tag >> 16U;
    const std::uint64_t size = packed != 0 ? packed : number(at_ + 4);
    const std::size_t from = at_ + (packed != 0 ? 4 : kTag);
    if (from > bytes_.size() || bytes_.size() - from < size) return {};
    at_ = packed != 0 ? at_ + kTag : from + (size + kTag - 1) / kTag * kTag;
    at_ = std::min(at_, bytes_.size());
    return bytes_.substr(from, size);
  }
  [[nodiscard]] std::uint64_t number(std::size_t at) const {
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < 4; ++i)
      n = 256 * n + static_cast<unsigned char>(bytes_[at + (little_ ? 3 - i : i)]);
    return n;
  }

 private:
  std::string_view bytes_;
  bool little_;
  std::size_t at_ = 0;
};

/// Reads a variable that is an object: flags of class 17, then its name, "MCOS" and its class.
std::optional<MatlabObject> object_of(std::string_view variable, bool little) {
  constexpr std::uint64_t kOpaque = 17;
  ElementFields fields(variable, little);
  const std::string_view flags = fields.next();
  if (flags.size() != 8) return {};
  if (const ElementFields word(flags, little); (word.number(0) & 0xFFU) != kOpaque) return {};
  MatlabObject out{.name = std::string(fields.next()), .class_name = {}};
  static_cast<void>(fields.next());
  out.class_name = std::string(fields.next());
  return out;
}

}  // namespace

MatlabElements whole_matlab_elements(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, kHeader> header{};
  if (!file.read(reinterpret_cast<char*>(header.data()), kHeader)) return {};
  const bool little = header[126] == 'I' && header[127] == 'M';
  if (!little && (header[126] != 'M' || header[127] != 'I')) return {};
  if (header[little ? 125 : 124] != 1) return {};
  const std::uintmax_t size = std::filesystem::file_size(path);
  MatlabElements out;
  for (std::uintmax_t at = kHeader; at + kTag <= size; ++out.count) {
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
    const std::string which = "variable " + std::to_string(out.count + 1);
    if (at > size)
      throw FileError(FileError::Kind::corrupt, path,
                      "is truncated: its " + which + " ends " + std::to_string(at - size) +
                          " bytes beyond the file");
    std::string head;
    if (type == kCompressed && !inflates(file, bytes, head))
      throw FileError(FileError::Kind::corrupt, path,
                      "is corrupt: its " + which + " does not match its checksum");
    if (type == kCompressed) {
      head.erase(0, kTag);
    } else {
      head.resize(std::min<std::uintmax_t>(bytes, kHead));
      file.read(head.data(), static_cast<std::streamsize>(head.size()));
    }
    if (auto object = object_of(head, little)) out.objects.push_back(std::move(*object));
  }
  return out;
}

}  // namespace wheeltap::io

#endif
