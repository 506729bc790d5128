// Reads a file in a process of its own, or writes one.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "base/parcel.hpp"
#include "io/file_error.hpp"

namespace wheeltap::io {

/// The bytes that `read` returns in a child of this process, so that a library that a damaged file
/// crashes, or keeps busy for ever, ends that child alone. What it prints is lost. FileError that
/// it throws is thrown here, other exceptions as std::runtime_error. Throws FileError (corrupt)
/// where the child crashes, takes more processor time than `seconds` (0: `most_seconds` of the
/// file's size), or more memory than `most_bytes` beyond this process's; std::bad_alloc where this
/// process may not take as much, or the system killed the child. Signals that ask the parent to
/// stop do not stop the child.
///
/// A child has this one thread: a lock that `read` needs must be held by the caller. Where no child
/// can be started, reads here.
[[nodiscard]] std::string read_apart(const std::filesystem::path& path,
                                     const std::function<std::string()>& read,
                                     double seconds = 0.0);

/// Reads there and drops what was read: what passes can be read here.
inline void check_apart(const std::filesystem::path& path, const std::function<void()>& read) {
  (void)read_apart(path, [&] {
    read();
    return std::string();
  });
}

/// `write` in such a child, without bounds: a library that a full disk makes crash, at whatever
/// time, ends that child alone. FileError that it throws is thrown here, and one (unwritable) of
/// `path` where the child crashes, lacks memory or is killed; other exceptions as above. Returns
/// false, without calling it, where no child can be started.
[[nodiscard]] bool write_apart(const std::filesystem::path& path,
                               const std::function<void()>& write);

/// Ten times and more what reading a sound file of that size takes.
[[nodiscard]] double most_seconds(std::uintmax_t bytes);

/// Several times what reading a sound file of that size takes, of compressed samples of 16 bits
/// 24 bytes for each of its bytes; bytes.
[[nodiscard]] double most_bytes(std::uintmax_t bytes);

/// As read_apart, of anything that a parcel carries.
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
