#include "apps/nearest.hpp"

#include <algorithm>
#include <numeric>

namespace wheeltap::apps {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const auto small = [](std::string_view text) {
    std::string out(text);
    for (char& c : out)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
  };
  for (const std::string& candidate : candidates)
    if (candidate != word && small(candidate) == small(word)) return candidate;
  std::string found;
  std::size_t best = word.size() / 3 + 2;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best) best = distance, found = candidate;
  }
  if (!found.empty()) return found;
  constexpr std::size_t kShortest = 4;  // shortest candidate for partial matches, in letters
  for (const std::string& candidate : candidates) {
    const bool within = candidate.size() >= kShortest && word.find(candidate) != word.npos;
    const bool begun = word.size() >= kShortest && std::string_view(candidate).starts_with(word);
    if ((within || begun) && candidate.size() > found.size()) found = candidate;
  }
  return found;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 20;
  const std::string meant = nearest(word, names);
  std::string text = meant.empty() ? "" : "; did you mean \"" + meant + "\"?";
  if (names.empty()) return text;
  text += meant.empty() ? "; there are: " : " (there are: ";
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMost) text += ", ...";
  return meant.empty() ? text : text + ")";
}

}  // namespace wheeltap::apps
