// Headers of columns in tables that Wheeltap writes.
#pragma once

#include <string>

namespace wheeltap::apps {

/// A header as a CSV cell: in quotes if it contains a comma, a quote or a line break.
[[nodiscard]] inline std::string csv_header(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace wheeltap::apps
