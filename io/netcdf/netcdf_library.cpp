#include "io/netcdf/netcdf_library.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <vector>

namespace wheeltap::io {
namespace {

/// HDF5 file format specification, II.A: superblocks of versions 2 and 3 end with a checksum of the
/// preceding bytes (lookup3 of Jenkins).
constexpr std::size_t kVersionAt = 8, kChecksumAt = 44;

/// lookup3 (hashlittle, Jenkins 2006) of `kChecksumAt` bytes: three whole blocks of three words,
/// then two words.
std::uint32_t lookup3(const std::string& bytes) {
  const auto word = [&](std::size_t i) {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[4 * i + k]);
    return value;
  };
  std::array<std::uint32_t, 3> x;
  x.fill(0xdeadbeef + static_cast<std::uint32_t>(kChecksumAt));
  auto& [a, b, c] = x;
  for (std::size_t i = 0; i < 9; i += 3) {
    a += word(i), b += word(i + 1), c += word(i + 2);
    a -= c, a ^= std::rotl(c, 4), c += b;
    b -= a, b ^= std::rotl(a, 6), a += c;
    c -= b, c ^= std::rotl(b, 8), b += a;
    a -= c, a ^= std::rotl(c, 16), c += b;
    b -= a, b ^= std::rotl(a, 19), a += c;
    c -= b, c ^= std::rotl(b, 4), b += a;
  }
  a += word(9), b += word(10);
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
  return c;
}

/// Corrects the checksum: H5Fget_file_image clears the mark of an open file but not the checksum.
void correct_superblock(std::string& bytes) {
  if (bytes.size() < kChecksumAt + 4 || bytes[kVersionAt] < 2 || bytes[kVersionAt] > 3) return;
  const std::uint32_t sum = lookup3(bytes);
  for (std::size_t k = 0; k < 4; ++k)
    bytes[kChecksumAt + k] = static_cast<char>(sum >> (8 * k) & 0xff);
}

}  // namespace

// NetCDF's in-memory files (nc_create_mem) do not track the creation order and cannot be reopened
// for writing. Diskless files behave like files on a disk, and HDF5 returns their bytes.
int NetcdfHandle::create_in_memory() {
  static std::atomic<int> made{0};
  name_ = "wheeltap-in-memory-" + std::to_string(++made);
  const int status = nc_create(name_.c_str(), NC_NETCDF4 | NC_DISKLESS | NC_CLOBBER, &id);
  open_ = status == NC_NOERR;
  return status;
}

int NetcdfHandle::create(const std::string& path) {
  const int status = nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &id);
  open_ = status == NC_NOERR;
  return status;
}

int NetcdfHandle::close_in_memory(std::string& bytes) {
  const int status = nc_sync(id);
  bytes.clear();
  std::vector<hid_t> files(
      static_cast<std::size_t>(std::max<ssize_t>(0, H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_FILE))));
  if (!files.empty()) H5Fget_obj_ids(H5F_OBJ_ALL, H5F_OBJ_FILE, files.size(), files.data());
  for (const hid_t file : files) {
    std::string name(name_.size() + 2, '\0');
    const ssize_t length = H5Fget_name(file, name.data(), name.size());
    if (length != static_cast<ssize_t>(name_.size()) || !name.starts_with(name_)) continue;
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    if (size <= 0 || H5Fget_file_image(file, bytes.data(), bytes.size()) != size) bytes.clear();
    break;
  }
  correct_superblock(bytes);
  const int closed = close();
  return status != NC_NOERR   ? status
         : closed != NC_NOERR ? closed
         : bytes.empty()      ? NC_EHDFERR
                              : NC_NOERR;
}

}  // namespace wheeltap::io
