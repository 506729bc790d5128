#include "io/formats/zip_archive.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

#include "io/file_error.hpp"
#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

constexpr std::uint64_t kEndSize = 22, kEntrySize = 46, kLocalSize = 30, kLocatorSize = 20;
constexpr std::uint64_t kLongestComment = 65535;
constexpr std::size_t kMostMembers = 100'000;
constexpr std::uint64_t kMostInflated = 1032;  // largest compression ratio of deflate
constexpr std::string_view kEndRecord("PK\5\6", 4), kEntry("PK\1\2", 4), kLocal("PK\3\4", 4),
    kEnd64("PK\6\6", 4), kLocator("PK\6\7", 4);

/// Inflates a deflate stream without header; empty if its length is not the stated length.
std::string inflated(std::string_view packed, std::uint64_t size) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  std::string out(size, '\0');
  std::uint64_t taken = 0, made = 0;
  int status = Z_OK;
  constexpr std::uint64_t kPiece = 1U << 30U;
  char beyond = 0;  // output address if the member is empty
  while (status == Z_OK) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(std::min(kPiece, packed.size() - taken));
    stream.next_out = reinterpret_cast<Bytef*>(made < size ? out.data() + made : &beyond);
    stream.avail_out = static_cast<uInt>(made < size ? std::min(kPiece, size - made) : 1);
    const uInt in = stream.avail_in, room = stream.avail_out;
    status = inflate(&stream, Z_NO_FLUSH);
    taken += in - stream.avail_in;
    made += room - stream.avail_out;
    if (made > size) break;
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END || made != size) out.clear();
  return out;
}

}  // namespace

ZipArchive::ZipArchive(std::string_view bytes, std::filesystem::path name)
    : bytes_(bytes), name_(std::move(name)) {
  read_directory();
}

void ZipArchive::corrupt(const std::string& why) const {
  throw FileError(FileError::Kind::corrupt, name_, why);
}

/// Reads a whole number of `bytes` bytes, little endian.
std::uint64_t ZipArchive::number(std::uint64_t at, int bytes) const {
  if (at > bytes_.size() || bytes_.size() - at < static_cast<std::uint64_t>(bytes))
    corrupt("is truncated or corrupt: its directory points beyond its end");
  std::uint64_t out = 0;
  for (int i = bytes; i-- > 0;)
    out = out << 8U | static_cast<unsigned char>(bytes_[at + static_cast<std::uint64_t>(i)]);
  return out;
}

void ZipArchive::read_directory() {
  if (!bytes_.starts_with(kLocal) && !bytes_.starts_with(kEndRecord))
    throw FileError(FileError::Kind::foreign, name_, "is not a ZIP archive");
  const std::size_t from =
      bytes_.size() - std::min<std::size_t>(bytes_.size(), kEndSize + kLongestComment);
  const std::size_t end = bytes_.rfind(kEndRecord);
  if (end == std::string_view::npos || end < from || bytes_.size() - end < kEndSize)
    corrupt("is truncated: the directory at the end of its ZIP archive is missing");
  std::uint64_t count = number(end + 10, 2), at = number(end + 16, 4);
  if (end >= kLocatorSize && bytes_.substr(end - kLocatorSize).starts_with(kLocator)) {
    const std::uint64_t end64 = number(end - kLocatorSize + 8, 8);
    if (end64 > bytes_.size() || !bytes_.substr(end64).starts_with(kEnd64))
      corrupt("is corrupt: its ZIP64 directory is not at the stated position");
    count = number(end64 + 32, 8);
    at = number(end64 + 48, 8);
  }
  if (count > kMostMembers)
    corrupt("has " + std::to_string(count) + " members: at most " + std::to_string(kMostMembers) +
            " are read");
  for (std::uint64_t i = 0; i < count; ++i) {
    if (at > bytes_.size() || !bytes_.substr(at).starts_with(kEntry))
      corrupt("is truncated or corrupt: its directory lacks member " + std::to_string(i + 1));
    ZipMember member{.packed = number(at + 20, 4),
                     .size = number(at + 24, 4),
                     .offset = number(at + 42, 4),
                     .checksum = static_cast<std::uint32_t>(number(at + 16, 4)),
                     .method = static_cast<int>(number(at + 10, 2))};
    if ((number(at + 8, 2) & 1U) != 0) member.method = -1;  // encrypted
    const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2);
    static_cast<void>(number(at + kEntrySize, 0));
    member.name =
        std::string(bytes_.substr(std::min<std::uint64_t>(at + kEntrySize, bytes_.size()), name));
    // ZIP64: the extra field 1 contains the numbers that exceed 32 bits, in this order.
    for (std::uint64_t e = at + kEntrySize + name; e + 4 <= at + kEntrySize + name + extra;) {
      const std::uint64_t kind = number(e, 2), length = number(e + 2, 2);
      std::uint64_t field = e + 4;
      const std::uint64_t last = field + length;
      constexpr std::uint64_t kElsewhere = 0xFFFFFFFF;
      for (std::uint64_t* value : {&member.size, &member.packed, &member.offset})
        if (kind == 1 && *value == kElsewhere && field + 8 <= last) {
          *value = number(field, 8);
          field += 8;
        }
      e = last;
    }
    at += kEntrySize + name + extra + number(at + 32, 2);
    members_.push_back(std::move(member));
  }
}

const ZipMember* ZipArchive::find(std::string_view name) const {
  const auto found = std::ranges::find(members_, name, &ZipMember::name);
  return found == members_.end() ? nullptr : &*found;
}

std::string ZipArchive::read(const ZipMember& member, std::uint64_t largest) const {
  const std::string shown = "its member \"" + printable(in_utf8(member.name)) + "\" ";
  if (member.method == -1) corrupt(shown + "is encrypted: save it without a password");
  if (member.method != 0 && member.method != 8)
    corrupt(shown + "is compressed by method " + std::to_string(member.method) +
            ": only stored and deflated members are read");
  if (member.size > largest)
    corrupt(shown + "has " + std::to_string(member.size) + " bytes: at most " +
            std::to_string(largest) + " are read");
  if (member.offset > bytes_.size() || !bytes_.substr(member.offset).starts_with(kLocal))
    corrupt(shown + "is not at the position that the directory states");
  const std::uint64_t at =
      member.offset + kLocalSize + number(member.offset + 26, 2) + number(member.offset + 28, 2);
  if (at > bytes_.size() || bytes_.size() - at < member.packed) corrupt(shown + "is truncated");
  const std::string_view packed = bytes_.substr(at, member.packed);
  if (member.size / kMostInflated > member.packed ||
      (member.method == 0 && packed.size() != member.size))
    corrupt(shown + "declares " + std::to_string(member.size) + " bytes, more than it can hold");
  std::string out = member.method == 0 ? std::string(packed) : inflated(packed, member.size);
  if (out.size() != member.size) corrupt(shown + "is corrupt: it cannot be unpacked");
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION  // a fuzzer would not get past checksums
  uLong checksum = crc32(0, nullptr, 0);
  for (std::size_t done = 0; done < out.size();) {
    const std::size_t piece = std::min<std::size_t>(out.size() - done, 1U << 30U);
    checksum = crc32(checksum, reinterpret_cast<const Bytef*>(out.data() + done),
                     static_cast<uInt>(piece));
    done += piece;
  }
  if (checksum != member.checksum) corrupt(shown + "is corrupt: it does not match its checksum");
#endif
  return out;
}

}  // namespace wheeltap::io
