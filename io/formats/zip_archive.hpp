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
  std::uint64_t packed = 0, size = 0;  ///< bytes in the archive, and uncompressed
  std::uint64_t offset = 0;            ///< of its local header
  std::uint32_t checksum = 0;          ///< CRC-32
  int method = 0;                      ///< 0 stored, 8 deflated
};

/// The members of an archive in memory. The memory must outlive this object.
class ZipArchive {
 public:
  /// Reads the directory at the archive's end, including ZIP64. Throws FileError: foreign for other
  /// files, corrupt for a truncated or damaged archive. Messages use `name` for the file.
  ZipArchive(std::string_view bytes, std::filesystem::path name);

  [[nodiscard]] const std::vector<ZipMember>& members() const { return members_; }
  [[nodiscard]] const ZipMember* find(std::string_view name) const;
  /// The uncompressed bytes of a member, checked against its size and checksum. Throws FileError
  /// (corrupt), also for an encrypted member, another compression method, or a size above
  /// `largest`.
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
