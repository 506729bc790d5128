#include "io/text/text_number.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>

#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

bool is_exponent_mark(char c) {
  return c == 'e' || c == 'E' || c == 'd' || c == 'D';
}

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Converts the text for std::from_chars, with a decimal point and the exponent mark 'e'. Returns
/// false if the text cannot be a number. Digits must follow a comma, so "1," is invalid.
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
  std::string changed, with_minus;
  if (constexpr std::string_view kMinus = "\xE2\x88\x92"; text.starts_with(kMinus)) {
    with_minus = "-" + std::string(text.substr(kMinus.size()));
    text = with_minus;
  }
  if (decimal != '.' || text.find_first_of("dD") != std::string_view::npos) {
    if (!in_c_notation(text, decimal, changed)) return std::nullopt;
    text = changed;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> parse_grouped_number(std::string_view text, char decimal, bool proven) {
  std::string_view rest = text;
  std::string plain;
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) {
    plain += rest.front();
    rest.remove_prefix(1);
  }
  const auto take_digits = [&] {
    std::size_t count = 0;
    while (!rest.empty() && is_digit(rest.front())) {
      plain += rest.front();
      rest.remove_prefix(1);
      ++count;
    }
    return count;
  };
  const bool zero = rest.starts_with('0');
  if (const std::size_t first = take_digits(); first < 1 || first > 3 || zero) return std::nullopt;
  constexpr std::string_view kMarks[] = {
      "'", ",", ".", " ", "\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89", "\xE2\x80\x99"};
  const auto* const mark =
      std::ranges::find_if(kMarks, [&](std::string_view m) { return rest.starts_with(m); });
  if (mark == std::end(kMarks) || *mark == std::string_view(&decimal, 1)) return std::nullopt;
  int groups = 0;
  while (rest.starts_with(*mark)) {
    rest.remove_prefix(mark->size());
    if (take_digits() != 3) return std::nullopt;
    ++groups;
  }
  const bool fraction = rest.starts_with(decimal);
  if (fraction) {
    plain += '.';
    rest.remove_prefix(1);
    if (take_digits() == 0) return std::nullopt;
  }
  if (!rest.empty()) return std::nullopt;
  const bool could_be_decimal = *mark == "," || *mark == ".";
  if (could_be_decimal && groups == 1 && !fraction && !proven) return std::nullopt;
  return parse_number(plain);
}

bool is_missing_value(std::string_view text) {
  if (text.empty()) return true;
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  // A missing value may consist of signs only: "-", "---.--", "****", "#####", "?".
  if (low.find_first_not_of("-*#?._ ") == std::string::npos) return true;
  if (low.starts_with('-') || low.starts_with('+')) low.erase(0, 1);
  for (const std::string_view known :
       {"na",     "n/a",     "null",    "none",    "<na>",     "nat",      "#n/a",
        "#na",    "#num!",   "#value!", "#div/0!", "#ref!",    "#name?",   "#null!",
        "#nv",    "#wert!",  "#zahl!",  "#bezug!", "#valeur!", "#nombre!", "1.#qnan",
        "1.#ind", "1.#snan", "1,#qnan", "1,#ind",  "1.#inf",   "1,#inf",   "\xE2\x88\x9E"})
    if (low == known) return true;
  return false;
}

bool is_missing_word(std::string_view text) {
  if (is_missing_value(text)) return true;
  std::string low;
  for (const char c : text)
    if (c != ' ' && c != '_' && c != '-' && c != '+')
      low += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const std::string_view known :
       {"missing", "nodata", "invalid", "bad", "overflow", "overload", "overrange", "underrange",
        "underflow", "over", "under", "ovl", "ovr", "ol", "err", "error", "fault", "i/otimeout",
        "timeout"})
    if (low == known) return true;
  return false;
}

// Digits without point (below 2⁵³) and powers of ten up to 10²² are exact doubles. The product or
// quotient of both is then rounded once, to the nearest double (Clinger 1990, "How to read floating
// point numbers accurately", section 3). std::from_chars converts all other numbers.
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
        // Nineteen digits fit into 64 bits; std::from_chars converts longer numbers.
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
