#include "io/fingerprint.hpp"

#include <cstdio>

#include "io/bytes.hpp"

namespace wheeltap::io {
namespace {

std::string digits_of(std::uint64_t hash) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

}  // namespace

std::string fingerprint(std::string_view text) {
  return digits_of(fnv1a(text));
}

FileFingerprint fingerprint_of_file(const std::filesystem::path& path) {
  FileFingerprint out;
  std::uint64_t hash = fnv1a("");
  each_piece(path, [&](std::string_view piece) {
    out.bytes += piece.size();
    hash = fnv1a(piece, hash);
  });
  out.digits = digits_of(hash);
  return out;
}

}  // namespace wheeltap::io
