// Parsing of whole numbers in command lines and cases.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace wheeltap::apps {

/// x as a whole number in [lowest, highest]; empty if x is not a whole number in this range.
[[nodiscard]] inline std::optional<std::int64_t> whole_number(double x, std::int64_t lowest,
                                                              std::int64_t highest) {
  // 2^53; all smaller whole numbers are exact doubles
  constexpr double kExact = 9007199254740992.0;
  if (!(std::fabs(x) <= kExact) || std::trunc(x) != x) return {};
  const auto n = static_cast<std::int64_t>(x);
  return n >= lowest && n <= highest ? std::optional(n) : std::nullopt;
}

/// `text` as a whole number in [lowest, highest]: "5", "-3", "5.0", "1e6". The result is empty for
/// any other text and for numbers out of range.
[[nodiscard]] inline std::optional<std::int64_t> whole_number(std::string_view text,
                                                              std::int64_t lowest,
                                                              std::int64_t highest) {
  const char *first = text.data(), *last = first + text.size();
  std::int64_t n = 0;
  if (const auto [end, error] = std::from_chars(first, last, n); end == last && !text.empty()) {
    if (error != std::errc()) return {};
    return n >= lowest && n <= highest ? std::optional(n) : std::nullopt;
  }
  double x = 0.0;
  const auto [end, error] = std::from_chars(first, last, x);
  if (error != std::errc() || end != last) return {};
  return whole_number(x, lowest, highest);
}

}  // namespace wheeltap::apps
