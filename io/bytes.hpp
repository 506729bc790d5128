// Reads the bytes of files; all user files that are read whole are opened here.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Largest size of a file that is read whole [bytes].
constexpr std::size_t kLargestFile = std::size_t{4} << 30U;

/// Reads the whole file. Throws FileError: missing if the file does not exist, cannot be read, or
/// is not a regular file (a pipe or a device could block for ever); corrupt if it has more than
/// `largest` bytes.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path,
                                     std::size_t largest = kLargestFile);

/// Reads at most this many bytes from the beginning. Throws the exceptions of `read_bytes`.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t most,
                                      std::size_t largest = kLargestFile);

/// Reads a file of any length in pieces and passes each to `take`. Throws FileError (missing) under
/// the same conditions as `read_bytes`.
void each_piece(const std::filesystem::path& path,
                const std::function<void(std::string_view)>& take);

}  // namespace wheeltap::io
