#include "apps/json_syntax.hpp"

#include <algorithm>
#include <utility>

#include "apps/written_number.hpp"
#include "io/text/words.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::string_view kJsonBlank = " \t\r\n";

/// Position of the last byte before `at` that is not a blank; npos if there are only blanks.
std::size_t last_before(std::string_view text, std::size_t at) {
  return at == 0 ? std::string_view::npos : text.find_last_not_of(kJsonBlank, at - 1);
}

/// The digits, signs and decimal points next to position `at`.
std::string_view number_around(std::string_view text, std::size_t at) {
  const auto of_number = [](char c) { return io::is_digit(c) || c == '.' || c == '-' || c == '+'; };
  std::size_t first = at, last = at;
  while (first > 0 && of_number(text[first - 1])) --first;
  while (last < text.size() && of_number(text[last])) ++last;
  return text.substr(first, last - first);
}

}  // namespace

std::string syntax_remedy(std::string_view text, std::size_t at) {
  at = std::min(at, text.size());
  // Find the word in which the parser stopped.
  constexpr std::string_view kEnds = ",:[]{}\n\"";
  const std::size_t opened = at == 0 ? std::string_view::npos : text.find_last_of(kEnds, at - 1);
  std::size_t first = opened == std::string_view::npos ? 0 : opened + 1;
  first = std::min(text.find_first_not_of(kJsonBlank, first), text.size());
  const std::size_t end = std::min(text.find_first_of(",:[]{}\n\"", first), text.size());
  std::string_view word = text.substr(first, end - first);
  word = word.substr(0, word.find_last_not_of(kJsonBlank) + 1);
  const char here = at < text.size() ? text[at] : '\0';
  const std::size_t previous = last_before(text, first);
  const char ahead = previous == std::string_view::npos ? '\0' : text[previous];

  if (at >= text.size()) {
    const auto open = [&](char one, char other) {
      return std::ranges::count(text, one) - std::ranges::count(text, other);
    };
    if (open('{', '}') > 0) return "; the text ends early: a } is missing";
    if (open('[', ']') > 0) return "; the text ends early: a ] is missing";
    return {};
  }
  if (word.starts_with("//") || word.starts_with("/*") || word.starts_with('#'))
    return "; JSON has no comments: remove the comment, or write \"notes\": \"...\" in the case";
  if ((here == ']' || here == '}') && last_before(text, at) != std::string_view::npos &&
      text[last_before(text, at)] == ',')
    return std::string("; remove the comma before the ") + here;
  for (const auto& [other, json] :
       {std::pair{"True", "true"}, std::pair{"False", "false"}, std::pair{"None", "null"},
        std::pair{"yes", "true"}, std::pair{"no", "false"}})
    if (word == other) return std::string("; write ") + json;
  if (word == "NaN" || word == "nan" || word == "NA")
    return ahead == ':' ? "; write a number, or leave out the key: JSON has no NaN"
                        : "; write a number, or null for a mode not measured";
  // "length": 0,9 is parsed as a number, a comma, and a number in place of a key.
  if (io::is_digit(here) || here == '-') {
    const std::size_t comma = last_before(text, at);
    if (comma != std::string_view::npos && text[comma] == ',' && comma > 0 &&
        io::is_digit(text[comma - 1]) && comma + 1 == at) {
      const std::string number =
          std::string(number_around(text, comma)) + "," + std::string(number_around(text, at));
      if (const auto value = written_number(number))
        return "; write " + pasted(value->value) + ": use a decimal point, not a comma";
    }
  }
  if (word.starts_with('\'')) {
    const std::size_t closing = word.find('\'', 1);
    return "; strings need double quotes: write \"" +
           std::string(word.substr(1, closing == std::string_view::npos ? closing : closing - 1)) +
           "\"";
  }
  if (const std::string number = number_to_write(word); !number.empty() && ahead != '}')
    return "; " + number;
  const std::size_t after = text.find_first_not_of(kJsonBlank, end);
  const bool name = !word.empty() && word.find_first_not_of(
                                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
                                         "0123456789-. ") == std::string_view::npos;
  if (name && after != std::string_view::npos && text[after] == ':' &&
      (ahead == '{' || ahead == ','))
    return "; keys need double quotes: write \"" + std::string(word) + "\":";
  // If a text follows a value directly, the parser stops at the end of the text.
  std::size_t start = first;
  if (here == '"') start = at > 0 ? text.rfind('"', at - 1) : at;
  const std::size_t value_end =
      here == '"' && start != std::string_view::npos ? last_before(text, start) : previous;
  if (here == '"' && value_end != std::string_view::npos &&
      (io::is_digit(text[value_end]) ||
       std::string_view("\"]}el").find(text[value_end]) != std::string_view::npos))
    return "; a comma is missing before it";
  if ((here == '{' || here == '[') && last_before(text, at) != std::string_view::npos &&
      std::string_view("]}").find(text[last_before(text, at)]) != std::string_view::npos)
    return "; a comma is missing before it";
  if (name && (ahead == ':' || ahead == '[' || ahead == ','))
    return "; strings need double quotes: write \"" + std::string(word) + "\"";
  return {};
}

}  // namespace wheeltap::apps
