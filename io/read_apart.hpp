// Reading and writing of a file in a child process.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "base/parcel.hpp"
#include "io/file_error.hpp"

namespace wheeltap::io {

/// Calls `read` in a child process and returns the bytes that `read` returns. If a corrupt file
/// causes a library to crash or to enter an endless loop, only the child process is affected. Text
/// that the child prints is lost. A FileError of `read` is rethrown here. Other exceptions are
/// rethrown as std::runtime_error. Throws FileError (corrupt) if the child crashes or exceeds a
/// limit. The limit of processor time is `seconds`; if `seconds` is 0, the limit is `most_seconds`
/// of the file's size. The memory limit of the child is the memory that this process currently uses
/// plus `most_bytes`. Throws std::bad_alloc if the system allows this process less memory than this
/// limit, or if the system killed the child. The child ignores the signals that request a stop.
///
/// The child contains only the calling thread, so the caller must hold any lock that `read` needs.
/// If the system cannot start a child process, this function calls `read` in this process.
[[nodiscard]] std::string read_apart(const std::filesystem::path& path,
                                     const std::function<std::string()>& read,
                                     double seconds = 0.0);

/// Calls `read` in a child process and discards the result. If the child succeeds, this process can
/// read the file without risk of a crash.
inline void check_apart(const std::filesystem::path& path, const std::function<void()>& read) {
  (void)read_apart(path, [&] {
    read();
    return std::string();
  });
}

/// Calls `write` in a child process without limits of time and memory. If a full disk causes a
/// library to crash, only the child process ends. A FileError of `write` is rethrown here. If the
/// child crashes, runs out of memory or is killed, this function throws FileError (unwritable) for
/// `path`. Other exceptions are rethrown as std::runtime_error. Returns false without calling
/// `write` if the system cannot start a child process.
[[nodiscard]] bool write_apart(const std::filesystem::path& path,
                               const std::function<void()>& write);

/// Limit of processor time [s] for a file of this size: at least ten times the time for reading a
/// valid file.
[[nodiscard]] double most_seconds(std::uintmax_t bytes);

/// Extra memory [bytes] for a file of this size: several times the memory for reading a valid file.
/// A file of compressed 16-bit samples needs 24 bytes of memory for each byte of the file.
[[nodiscard]] double most_bytes(std::uintmax_t bytes);

/// Calls `read` in a child process like read_apart; the result has any type that base/parcel.hpp
/// serialises.
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
