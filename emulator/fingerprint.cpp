#include "emulator/fingerprint.hpp"

#include <cstdio>

namespace wheeltap::emulator {

std::string fingerprint(std::string_view text) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(text)));
  return digits;
}

}  // namespace wheeltap::emulator
