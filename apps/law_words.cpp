#include "apps/law_words.hpp"

#include "base/constants.hpp"
#include "base/number.hpp"

namespace wheeltap::apps {

std::string plain_number(double x) {
  std::string text = base::number(x);
  for (const char* before : {"e+0", "e+"}) {
    if (const auto at = text.find(before); at != std::string::npos) {
      text.replace(at, std::string(before).size(), "e");
    }
  }
  return text;
}

bool has_short_form(const dynamics::LawInfo& info) {
  return !info.one_sided && !(info.size() > 1 && info.coefficients[1].required());
}

std::string keys_in_words(const dynamics::LawInfo& info) {
  std::string text;
  for (int i = 0; i < info.size(); ++i) {
    const auto& c = info.coefficients[static_cast<std::size_t>(i)];
    text += (text.empty() ? "" : ", ") + std::string(c.name) + " [" + std::string(c.unit) + "]";
  }
  return info.one_sided ? text + " and side" : text;
}

std::string law_in_words(const dynamics::LawInfo& info) {
  const auto& first = info.coefficients[0];
  return (has_short_form(info) ? std::string(first.name) + " [" + std::string(first.unit) +
                                     "] (a number or a parameter's name), "
                               : std::string()) +
         "an object with " + keys_in_words(info) + ", or a list of these (" +
         std::string(info.description) + "; `wheeltap laws " + std::string(info.name) + "`)";
}

std::string in_words(const dynamics::LawCoefficient& c) {
  return std::string(c.words) + " [" + std::string(c.unit) + "]: a number or a parameter's name" +
         (c.required() ? "" : "; default " + plain_number(c.otherwise));
}

std::string bounds_in_words(const dynamics::LawCoefficient& c) {
  const bool below = c.lower > -kInfinity, above = c.upper < kInfinity;
  std::string range;
  if (below && c.lower == 0.0 && c.above_lower) {
    range = "positive";
  } else if (below) {
    range = (c.above_lower ? "above " : "at least ") + plain_number(c.lower);
  }
  if (above) range += (below ? " and at most " : "at most ") + plain_number(c.upper);
  return range;
}

}  // namespace wheeltap::apps
