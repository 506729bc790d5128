// Reading the bytes of files. Wheeltap uses these functions to read any whole file of a user.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Largest file that Wheeltap reads into memory as a whole [bytes].
constexpr std::size_t kLargestFile = std::size_t{4} << 30U;

/// Reads the whole file. Throws FileError: missing if the file does not exist, cannot be read, or
/// is not a regular file (a pipe or a device could block for ever); corrupt if the file has more
/// than `largest` bytes.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path,
                                     std::size_t largest = kLargestFile);

/// Reads at most `most` bytes from the beginning of the file. Throws the same exceptions as
/// `read_bytes`.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t most,
                                      std::size_t largest = kLargestFile);

/// Reads a file of any length in blocks of bytes and passes each block to `take`. Throws FileError
/// (missing) under the same conditions as `read_bytes`.
void each_piece(const std::filesystem::path& path,
                const std::function<void(std::string_view)>& take);

}  // namespace wheeltap::io
