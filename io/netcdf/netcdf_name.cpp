#include "io/netcdf/netcdf_name.hpp"

#include <algorithm>

#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kLongest = 200;

bool may_begin(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

}  // namespace

std::optional<std::string> netcdf_name_error(std::string_view name) {
  if (name.empty()) return "must not be empty";
  if (name.size() > kLongest) {
    return "has " + std::to_string(name.size()) + " bytes, must have at most " +
           std::to_string(kLongest);
  }
  if (first_unprintable(name)) return "must be UTF-8 without control characters";
  if (!may_begin(name.front())) return "must begin with a letter, a digit or _";
  if (name.back() == ' ') return "must not end with a space";
  if (name.find('/') != std::string_view::npos) return "must not hold a /";
  return {};
}

std::string netcdf_name(std::string_view name) {
  std::string out(name);
  for (auto at = first_unprintable(out); at; at = first_unprintable(out)) out[*at] = '_';
  std::ranges::replace(out, '/', '_');
  if (out.size() > kLongest) {
    std::size_t end = kLongest;  // move to the start of a character
    while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xC0U) == 0x80U) --end;
    out.resize(end);
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  if (out.empty() || !may_begin(out.front())) out.insert(0, "_");
  return out;
}

}  // namespace wheeltap::io
