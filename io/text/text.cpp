#include "io/text/text.hpp"

#include <cstdio>

namespace wheeltap::io {
namespace {

struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;  // 0: the bytes are not UTF-8
};

// Decodes the character that starts at `at`.
Character character(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xF0 ? 4 : (first >= 0xE0 ? 3 : 2);
  if (first < 0xC2 || first > 0xF4) return {};
  char32_t code = first & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (overlong || surrogate || code > 0x10FFFF) return {};
  return {code, bytes};
}

bool is_printable(char32_t code) {
  const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool separator = code == 0x2028 || code == 0x2029;
  const bool direction = (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return !control && !separator && !direction;
}

}  // namespace

std::optional<std::size_t> first_unprintable(std::string_view text, std::string_view allowed) {
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character(text, at);
    const bool fine = c.bytes == 1 && allowed.find(text[at]) != std::string_view::npos;
    if (c.bytes == 0 || (!fine && !is_printable(c.code))) return at;
    at += c.bytes;
  }
  return {};
}

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character(text, at);
    char escaped[16];
    if (c.bytes == 0) {
      std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned char>(text[at]));
      out += escaped;
      ++at;
      continue;
    }
    if (is_printable(c.code)) {
      out += text.substr(at, c.bytes);
    } else if (c.code == '\n') {
      out += "\\n";
    } else if (c.code == '\t') {
      out += "\\t";
    } else if (c.code < 0x80) {
      std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned>(c.code));
      out += escaped;
    } else {
      std::snprintf(escaped, sizeof escaped, "\\u{%x}", static_cast<unsigned>(c.code));
      out += escaped;
    }
    at += c.bytes;
  }
  return out;
}

std::string in_utf8(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t bytes = character(text, at).bytes;
    if (bytes == 0) break;
    at += bytes;
  }
  if (at == text.size()) return std::string(text);
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6U));
      out += static_cast<char>(0x80 | (byte & 0x3FU));
    }
  }
  return out;
}

}  // namespace wheeltap::io
