// A reader of the lines of a universal file, for the functions that read the datasets.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/text.hpp"
#include "io/text/words.hpp"
#include "io/universal/universal_file.hpp"

namespace wheeltap::io::universal {

inline std::string text_of(std::string_view raw) {
  return in_utf8(trimmed(raw));
}

inline std::string none_is_empty(std::string_view text) {
  std::string word = text_of(text);
  return word == "NONE" ? std::string() : word;
}

/// Converts a Fortran number: "1.5E+00", "1.5D+00", "1.5-100", "1.5". Returns std::nullopt for any
/// other text.
inline std::optional<double> fortran_number(std::string_view field) {
  std::string text(trimmed(field));
  if (text.empty()) return {};
  if (text[0] == '+') text.erase(0, 1);
  for (char& c : text)
    if (c == 'D' || c == 'd') c = 'e';
  const auto sign = text.find_first_of("+-", 1);  // sign of an exponent without a letter
  if (sign != std::string::npos && std::string_view("eE").find(text[sign - 1]) == std::string::npos)
    text.insert(sign, "e");
  return parse_number(text);
}

inline std::string_view field(std::string_view line, std::size_t from, std::size_t width) {
  return from >= line.size() ? std::string_view() : line.substr(from, width);
}

/// The lines of a file with line numbers for error messages, and its raw bytes for dataset 58b.
class Reader {
 public:
  Reader(const std::string& bytes, const std::filesystem::path& name)
      : bytes_(bytes), name_(name) {}

  [[nodiscard]] bool done() const { return at_ >= bytes_.size(); }
  [[nodiscard]] std::ptrdiff_t line_number() const { return number_; }
  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(FileError::Kind::corrupt, name_, {.line = number_}, reason);
  }

  /// Reads the next line and returns it without its line break (LF, CR LF or CR). `what` names the
  /// expected content in messages.
  std::string_view next(const char* what) {
    if (done()) fail(std::string("the file ends where ") + what + " must follow");
    const std::size_t end = bytes_.find_first_of("\r\n", at_);
    const std::string_view line = std::string_view(bytes_).substr(
        at_, end == std::string::npos ? std::string::npos : end - at_);
    if (end == std::string::npos) {
      at_ = bytes_.size();
    } else {
      at_ =
          end + (bytes_[end] == '\r' && end + 1 < bytes_.size() && bytes_[end + 1] == '\n' ? 2 : 1);
    }
    ++number_;
    return line;
  }
  /// Returns the next line without advancing.
  [[nodiscard]] std::string_view peek() const {
    const std::size_t end = bytes_.find_first_of("\r\n", at_);
    return std::string_view(bytes_).substr(
        at_, end == std::string::npos ? std::string::npos : end - at_);
  }
  [[nodiscard]] bool at_separator() const { return !done() && trimmed(peek()) == "-1"; }

  std::string_view raw(std::size_t count) {
    if (bytes_.size() - at_ < count)
      fail("the file ends after " + std::to_string(bytes_.size() - at_) + " of " +
           std::to_string(count) + " bytes of binary data");
    const std::string_view out = std::string_view(bytes_).substr(at_, count);
    at_ += count;
    return out;
  }
  /// Skips the line break that some programs write after binary data.
  void skip_blanks() {
    while (!done() && std::string_view(" \t\r\n").find(bytes_[at_]) != std::string_view::npos) {
      number_ += bytes_[at_] == '\n';
      ++at_;
    }
    // The loop also skips the blanks that precede "-1" on its line.
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  int integer(std::string_view text, const char* what) const {
    const std::string_view word = trimmed(text);
    if (word.empty()) return 0;
    int value = 0;
    const char* first = word.data() + (word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      fail(std::string(what) + " '" + std::string(word) + "' must be a whole number");
    return value;
  }
  double number(std::string_view text, const char* what) const {
    if (trimmed(text).empty()) return 0.0;
    const auto value = fortran_number(text);
    if (!value) fail(std::string(what) + " '" + std::string(trimmed(text)) + "' is not a number");
    return *value;
  }
  /// Reads the whole numbers of a line in columns of `width` characters. If the numbers do not fit
  /// these columns, the line is split at blanks instead.
  std::vector<int> integers(std::string_view line, std::size_t width, const char* what) const {
    std::vector<int> out;
    const std::vector<std::string_view> words = split(line);
    bool columns = true;
    for (std::size_t at = 0; columns && at < line.size(); at += width) {
      const std::string_view word = trimmed(field(line, at, width));
      columns = word.find_first_of(" \t") == std::string_view::npos;
      const std::size_t edge = at + width;  // no number crosses the edge of a column
      if (edge < line.size() && line[edge - 1] != ' ' && line[edge] != ' ' && line[edge] != '-')
        columns = columns && word.size() == width;
    }
    if (columns) {
      for (std::size_t at = 0; at < line.size(); at += width)
        if (!trimmed(field(line, at, width)).empty())
          out.push_back(integer(field(line, at, width), what));
    } else {
      for (const std::string_view word : words) out.push_back(integer(word, what));
    }
    return out;
  }

  static std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> words;
    std::size_t at = 0;
    while ((at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      words.push_back(line.substr(at, end - at));
      at = end;
    }
    return words;
  }

  /// Reads `count` numbers from several lines. Each line has columns with the widths in `widths`;
  /// this list is repeated as often as necessary. If the numbers of a line are not in these
  /// columns, the line is split at blanks instead. A line may have fewer numbers than columns.
  std::vector<double> numbers(std::size_t count, const std::vector<std::size_t>& widths,
                              const char* what) {
    std::vector<double> out;
    out.reserve(std::min(count, left()));
    while (out.size() < count) {
      if (done() || at_separator())
        fail(std::string("only ") + std::to_string(out.size()) + " of " + std::to_string(count) +
             " " + what + " are there");
      const std::string_view line = next(what);
      if (trimmed(line).empty()) continue;
      const std::size_t before = out.size();
      if (!in_columns(line, widths, out)) {
        out.resize(before);
        for (const std::string_view word : split(line)) {
          const auto value = fortran_number(word);
          if (!value) fail("'" + std::string(word) + "' is not a number");
          out.push_back(*value);
        }
      }
      if (out.size() > count)
        fail("has " + std::to_string(out.size() - count) + " more " + what + " than were declared");
    }
    return out;
  }

 private:
  static bool in_columns(std::string_view line, const std::vector<std::size_t>& widths,
                         std::vector<double>& out) {
    std::size_t at = 0;
    const std::string_view text = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    for (std::size_t i = 0; at < text.size(); at += widths[i], i = (i + 1) % widths.size()) {
      const auto value = fortran_number(field(text, at, widths[i]));
      if (!value) return false;
      out.push_back(*value);
    }
    return true;
  }

  const std::string& bytes_;
  const std::filesystem::path& name_;
  std::size_t at_ = 0;
  std::ptrdiff_t number_ = 0;
};

/// Each function reads a dataset (15, 2411, 82, 2412 or 2420) and appends its content to `out`.
void read_nodes(Reader& in, std::vector<UniversalNode>& out);
void read_double_nodes(Reader& in, std::vector<UniversalNode>& out);
void read_traces(Reader& in, std::vector<UniversalTrace>& out);
void read_elements(Reader& in, std::vector<UniversalElement>& out);
void read_systems(Reader& in, std::vector<UniversalSystem>& out);

}  // namespace wheeltap::io::universal
