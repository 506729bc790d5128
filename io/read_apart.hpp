// Reads or writes a file in a child process.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "base/parcel.hpp"
#include "io/file_error.hpp"

namespace wheeltap::io {

/// Calls `read` in a child process and returns its bytes. If a damaged file causes a library to
/// crash or to loop for ever, only the child process is affected. Text that the child prints is
/// lost. A FileError of `read` is rethrown here, other exceptions as std::runtime_error. Throws
/// FileError (corrupt) if the child crashes, takes more processor time than `seconds` (or
/// `most_seconds` of the file's size if `seconds` is 0), or needs `most_bytes` more memory than
/// this process. Throws std::bad_alloc if the memory limit of this process is lower than that, or
/// if the system killed the child. The child ignores the signals that request a stop.
///
/// The child has only the calling thread: the caller must hold any lock that `read` needs. If no
/// child can be started, reads in this process.
[[nodiscard]] std::string read_apart(const std::filesystem::path& path,
                                     const std::function<std::string()>& read,
                                     double seconds = 0.0);

/// Reads the file in a child process and discards the result. If this succeeds, the file can be
/// read in this process.
inline void check_apart(const std::filesystem::path& path, const std::function<void()>& read) {
  (void)read_apart(path, [&] {
    read();
    return std::string();
  });
}

/// Calls `write` in a child process without limits. If a full disk causes a library to crash, only
/// the child process ends. A FileError of `write` is rethrown here; if the child crashes, lacks
/// memory or is killed, throws FileError (unwritable) for `path`. Other exceptions are rethrown as
/// std::runtime_error. Returns false without calling `write` if no child can be started.
[[nodiscard]] bool write_apart(const std::filesystem::path& path,
                               const std::function<void()>& write);

/// Limit of processor time [s]: at least ten times that for reading a valid file of this size.
[[nodiscard]] double most_seconds(std::uintmax_t bytes);

/// Memory limit [bytes]: several times that for reading a valid file of this size. Compressed
/// 16-bit samples need 24 bytes for each byte of the file.
[[nodiscard]] double most_bytes(std::uintmax_t bytes);

/// The same as read_apart, for a result of any type that base/parcel.hpp serialises.
template <class T>
[[nodiscard]] T read_apart_as(const std::filesystem::path& path, const std::function<T()>& read) {
  const std::string bytes = read_apart(path, [&] {
    base::Packer parcel;
    parcel(read());
    return std::move(parcel).bytes();
  });
  T out;
  base::Unpacker parcel(bytes);
  parcel(out);
  return out;
}

}  // namespace wheeltap::io
