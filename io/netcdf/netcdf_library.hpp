// The NetCDF library's own ways.
#pragma once

#include <hdf5.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <cstdint>
#include <mutex>
#include <string>

namespace wheeltap::io {

/// The NetCDF and HDF5 C libraries keep global state without locks: hold one of these while in
/// them. Not recursive: NetcdfWriter and NetcdfReader take none, their users do where threads write
/// or read at the same time.
class NetcdfLock {
 public:
  // HDF5 keeps its error printing a thread, and NetCDF turns it off in the first thread only.
  NetcdfLock() : lock_(mutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
};

/// An open NetCDF file, closed when it goes out of scope.
class NetcdfHandle {
 public:
  NetcdfHandle() = default;
  NetcdfHandle(const NetcdfHandle&) = delete;
  NetcdfHandle& operator=(const NetcdfHandle&) = delete;
  ~NetcdfHandle() {
    if (open_) nc_close(id);
  }
  void opened() { open_ = true; }
  [[nodiscard]] int close() {
    open_ = false;
    return nc_close(id);
  }
  /// A new NetCDF-4 file that HDF5 keeps in memory: on a full disk, HDF5 would end the program.
  [[nodiscard]] int create_in_memory();
  /// On the disk: in a process that HDF5 may end.
  [[nodiscard]] int create(const std::string& path);
  /// The same bytes that a file on the disk would have; the file is closed.
  [[nodiscard]] int close_in_memory(std::string& bytes);
  int id = -1;

 private:
  bool open_ = false;
  std::string name_;  // in memory
};

/// The type of a variable that holds such numbers as they are.
template <class Number>
inline constexpr nc_type kNetcdfType = NC_NAT;
template <>
inline constexpr nc_type kNetcdfType<double> = NC_DOUBLE;
template <>
inline constexpr nc_type kNetcdfType<float> = NC_FLOAT;
template <>
inline constexpr nc_type kNetcdfType<std::int64_t> = NC_INT64;
template <>
inline constexpr nc_type kNetcdfType<std::int32_t> = NC_INT;
template <>
inline constexpr nc_type kNetcdfType<std::int16_t> = NC_SHORT;
template <>
inline constexpr nc_type kNetcdfType<std::uint8_t> = NC_UBYTE;
template <>
inline constexpr nc_type kNetcdfType<char> = NC_CHAR;

/// What the first bytes of a NetCDF-4 file are (HDF5's signature).
inline constexpr char kNetcdfMagic[] = "\x89HDF\r\n\x1a\n";

}  // namespace wheeltap::io
