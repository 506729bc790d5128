// ZIP archives (PKWARE, APPNOTE 6.3), as NumPy and spreadsheets write them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

struct ZipMember {
  std::string name = {};
  std::uint64_t packed = 0, size = 0;  ///< number of bytes in the archive; number of uncompressed
                                       ///< bytes
  std::uint64_t offset = 0;            ///< offset of the member's local header in the archive
                                       ///< [bytes]
  std::uint32_t checksum = 0;          ///< CRC-32
  int method = 0;                      ///< 0 stored, 8 deflated
};

/// A ZIP archive in memory. The memory must outlive this object.
class ZipArchive {
 public:
  /// Reads the directory of members at the end of the archive, also in the ZIP64 format. Throws
  /// FileError: foreign for other formats, corrupt for a truncated or invalid archive. Messages use
  /// `name` for the file.
  ZipArchive(std::string_view bytes, std::filesystem::path name);

  [[nodiscard]] const std::vector<ZipMember>& members() const { return members_; }
  [[nodiscard]] const ZipMember* find(std::string_view name) const;
  /// Returns the uncompressed bytes of a member. Throws FileError (corrupt) if the bytes do not
  /// match the size or the checksum of the member. Also throws FileError (corrupt) for an encrypted
  /// member, another compression method, or a size above `largest`.
  [[nodiscard]] std::string read(const ZipMember& member, std::uint64_t largest) const;

 private:
  [[noreturn]] void corrupt(const std::string& why) const;
  [[nodiscard]] std::uint64_t number(std::uint64_t at, int bytes) const;
  void read_directory();

  std::string_view bytes_;
  std::filesystem::path name_;
  std::vector<ZipMember> members_;
};

}  // namespace wheeltap::io
