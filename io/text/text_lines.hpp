// Iteration over the lines of a text.
#pragma once

#include <string_view>

namespace wheeltap::io {

/// An iterator over the lines of a text. Line numbers start at 1; LF and CR LF end a line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number;
    return true;
  }
  std::string_view line;
  int number = 0;

 private:
  std::string_view rest_;
};

}  // namespace wheeltap::io
