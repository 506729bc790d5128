// Search for the name nearest to a misspelt word ("did you mean …?").
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::apps {

/// Levenshtein distance (1966): the fewest insertions, deletions and substitutions between two
/// words.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word` by edit distance, if the distance is at most one plus a third of
/// the word's length. If no candidate satisfies this condition, the result is the longest candidate
/// of at least four letters that `word` contains ("frequencies_hz") or that begins with `word`
/// ("freq"). Empty if no candidate meets these conditions.
[[nodiscard]] std::string nearest(std::string_view word,
                                  const std::vector<std::string>& candidates);

/// A suggestion with the nearest name and the first twenty names: "; did you mean "B"? (there are:
/// A, B, C)".
[[nodiscard]] std::string did_you_mean(std::string_view word,
                                       const std::vector<std::string>& names);

}  // namespace wheeltap::apps
