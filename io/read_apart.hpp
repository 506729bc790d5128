// Reads or writes a file in a child process.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "base/parcel.hpp"
#include "io/file_error.hpp"

namespace wheeltap::io {

/// Calls `read` in a child process and returns its bytes. If a damaged file makes a library crash
/// or run for ever, only the child ends. Its printed output is lost. A FileError of `read` is
/// rethrown here, other exceptions as std::runtime_error. Throws FileError (corrupt) if the child
/// crashes, takes more processor time than `seconds` (0: `most_seconds` of the file's size), or
/// more memory than `most_bytes` beyond that of this process. Throws std::bad_alloc if this process
/// may not use as much memory or the system killed the child. Signals that ask the parent to stop
/// do not stop the child.
///
/// The child has only the calling thread: the caller must hold any lock that `read` needs. If no
/// child can be started, reads in this process.
[[nodiscard]] std::string read_apart(const std::filesystem::path& path,
                                     const std::function<std::string()>& read,
                                     double seconds = 0.0);

/// Reads in the child and drops the result: a file that passes can be read in this process.
inline void check_apart(const std::filesystem::path& path, const std::function<void()>& read) {
  (void)read_apart(path, [&] {
    read();
    return std::string();
  });
}

/// Calls `write` in a child process without limits. If a full disk makes a library crash, at any
/// time, only the child ends. A FileError of `write` is rethrown here; if the child crashes, lacks
/// memory or is killed, throws FileError (unwritable) for `path`; other exceptions as above.
/// Returns false without calling `write` if no child can be started.
[[nodiscard]] bool write_apart(const std::filesystem::path& path,
                               const std::function<void()>& write);

/// At least ten times the reading time of a valid file of that size.
[[nodiscard]] double most_seconds(std::uintmax_t bytes);

/// Several times the memory for reading a valid file of that size [bytes]; compressed samples of 16
/// bits take 24 bytes for each byte of the file.
[[nodiscard]] double most_bytes(std::uintmax_t bytes);

/// Like read_apart, for any type that a parcel carries.
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
