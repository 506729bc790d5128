#include "io/text_number.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>

namespace wheeltap::io {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_exponent_mark(char c) {
  return c == 'e' || c == 'E' || c == 'd' || c == 'D';
}

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// The text as std::from_chars wants it: with a point and with 'e'. False where it cannot be a
/// number: a comma is digits' only where digits follow it, so that "1," is none.
bool in_c_notation(std::string_view text, char decimal, std::string& out) {
  out.assign(text);
  for (std::size_t i = 0; i < out.size(); ++i) {
    char& c = out[i];
    if (decimal != '.' && c == '.') return false;
    if (decimal != '.' && c == decimal) {
      if (i + 1 == out.size() || !is_digit(out[i + 1])) return false;
      c = '.';
    }
    if ((c == 'd' || c == 'D') && i > 0 && (is_digit(out[i - 1]) || out[i - 1] == '.')) c = 'e';
  }
  return true;
}

}  // namespace

std::optional<double> parse_number(std::string_view text, char decimal) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  std::string changed;
  if (decimal != '.' || text.find_first_of("dD") != std::string_view::npos) {
    if (!in_c_notation(text, decimal, changed)) return std::nullopt;
    text = changed;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_missing_value(std::string_view text) {
  if (text.empty()) return true;
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (low.starts_with('-') || low.starts_with('+')) low.erase(0, 1);
  for (const std::string_view known : {"na", "n/a", "null", "none", "#n/a", "#num!", "#value!",
                                       "1.#qnan", "1.#ind", "1.#snan", "1,#qnan", "1.#inf"})
    if (low == known) return true;
  return false;
}

// Digits without point and powers of ten up to 10²² are doubles where the former stay below 2⁵³:
// their product or quotient is then rounded once, to the nearest double (Clinger 1990, "How to
// read floating point numbers accurately", section 3). All others go to std::from_chars.
const char* read_number(const char* p, const char* end, double& value, PrintedDigits& printed,
                        char decimal) {
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  const char* const start = p;
  std::uint64_t mantissa = 0;
  int significant = 0, after_point = 0, digits = 0;
  bool point = false;
  for (; p < end; ++p) {
    if (is_digit(*p)) {
      ++digits;
      if (significant > 0 || *p != '0') {
        // Nineteen digits fit; more are left to from_chars.
        if (++significant <= 19) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p - '0');
      }
      if (point) ++after_point;
    } else if (*p == decimal && !point) {
      point = true;
    } else {
      break;
    }
  }
  if (digits == 0 || (decimal != '.' && point && after_point == 0)) return nullptr;
  int exponent = 0;
  if (p < end && is_exponent_mark(*p)) {
    const char* q = p + 1;
    const bool down = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+')) ++q;
    if (q == end || !is_digit(*q)) return nullptr;
    for (; q < end && is_digit(*q); ++q) exponent = std::min(10 * exponent + (*q - '0'), 100'000);
    if (down) exponent = -exponent;
    p = q;
  }
  const int power = exponent - after_point;
  if (significant <= 19 && mantissa <= (std::uint64_t{1} << 53) && power >= -22 && power <= 22) {
    const auto whole = static_cast<double>(mantissa);
    value = power < 0 ? whole / kPowers[-power] : whole * kPowers[power];
  } else {
    const std::optional<double> parsed =
        parse_number({start, static_cast<std::size_t>(p - start)}, decimal);
    if (!parsed) return nullptr;
    value = *parsed;
  }
  if (negative) value = -value;
  printed.decimals = std::max(printed.decimals, -power);
  printed.digits = std::max(printed.digits, significant);
  return p;
}

}  // namespace wheeltap::io
