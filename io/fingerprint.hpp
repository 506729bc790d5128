// Short hashes to distinguish strings and files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// 64-bit FNV-1a hash of the bytes. The hash identifies cases; it is not secure against forgery.
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view bytes,
                                            std::uint64_t hash = 0xcbf29ce484222325) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

/// The FNV-1a hash of the string `text` as 16 hexadecimal digits.
[[nodiscard]] std::string fingerprint(std::string_view text);

/// The FNV-1a hash of a file's bytes, and the number of bytes.
struct FileFingerprint {
  std::uintmax_t bytes = 0;
  std::string digits;
};
/// Computes the hash of a file; the file may be larger than the memory. Throws FileError (missing).
[[nodiscard]] FileFingerprint fingerprint_of_file(const std::filesystem::path& path);

}  // namespace wheeltap::io
