#include "io/date_of_files.hpp"

#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace wheeltap::io {

std::time_t date_of_files() {
  constexpr const char* kVariable = "SOURCE_DATE_EPOCH";
  constexpr std::time_t kEndOfYear9999 = 253'402'300'799;  // s
  const char* const stated = std::getenv(kVariable);
  if (stated == nullptr) return std::time(nullptr);
  const std::string text = stated;
  std::time_t t = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), t);
  if (error != std::errc() || end != text.data() + text.size() || t < 0 || t > kEndOfYear9999)
    throw std::invalid_argument(std::string(kVariable) + ": " + text +
                                ": must be a whole number of seconds from 0 to " +
                                std::to_string(kEndOfYear9999));
  return t;
}

}  // namespace wheeltap::io
