// Adapters to the NetCDF library.
#pragma once

#include <hdf5.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <cstdint>
#include <mutex>
#include <string>

namespace wheeltap::io {

/// Lock for the NetCDF and HDF5 C libraries, which keep global state without locks. The caller must
/// hold the lock during every call of these libraries. The lock is not recursive. NetcdfWriter and
/// NetcdfReader do not take the lock. If several threads read or write files, the callers of
/// NetcdfWriter and NetcdfReader must hold the lock.
class NetcdfLock {
 public:
  // Turns off the error messages of HDF5 in this thread. This setting is specific to each thread,
  // and the NetCDF library turns off the messages only in the first thread.
  NetcdfLock() : lock_(mutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
};

/// The handle of an open NetCDF file. The destructor closes the file.
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
  /// Creates a NetCDF-4 file in memory. A file on the disk would be unsafe, because HDF5 terminates
  /// the program if the disk is full.
  [[nodiscard]] int create_in_memory();
  /// Creates a file on the disk. Call this function only in a process that HDF5 may terminate.
  [[nodiscard]] int create(const std::string& path);
  /// Closes the file in memory and stores in `bytes` the content that the file would have on the
  /// disk.
  [[nodiscard]] int close_in_memory(std::string& bytes);
  int id = -1;

 private:
  bool open_ = false;
  std::string name_;  // name of the file in memory
};

/// The NetCDF type that stores numbers of type Number without conversion.
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

/// The first bytes of a NetCDF-4 file (the signature of HDF5).
inline constexpr char kNetcdfMagic[] = "\x89HDF\r\n\x1a\n";

}  // namespace wheeltap::io
