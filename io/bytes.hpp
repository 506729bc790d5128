// A file's bytes: the one place where files of a user are opened whose bytes are read whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// More than any record is long, and less than what fills a machine.
constexpr std::size_t kLargestFile = std::size_t{4} << 30U;

/// All of them. Throws FileError: missing where the file is not there, cannot be read, or is not a
/// regular file (a pipe, for which one might wait for ever, or a device that never ends); corrupt
/// where it has more than `largest` bytes.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path,
                                     std::size_t largest = kLargestFile);

/// At most so many from its beginning. Throws as `read_bytes` does.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t most,
                                      std::size_t largest = kLargestFile);

/// All of them, some at a time: `take` is given one piece after the other, of a file of any length.
/// Throws FileError (missing) as `read_bytes` does.
void each_piece(const std::filesystem::path& path,
                const std::function<void(std::string_view)>& take);

}  // namespace wheeltap::io
