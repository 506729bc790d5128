#include "io/fingerprint.hpp"

#include <cstdio>

namespace wheeltap::io {

std::string fingerprint(std::string_view text) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(text)));
  return digits;
}

}  // namespace wheeltap::io
