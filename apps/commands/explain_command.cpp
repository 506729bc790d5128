#include <algorithm>
#include <iostream>
#include <set>
#include <sstream>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/cases/syntax/key_places.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/nearest.hpp"

namespace wheeltap::apps {
namespace {

using Path = std::vector<std::string>;

Path parts_of(const std::string& key) {
  std::string text = key;
  std::ranges::replace(text, '/', '.');
  Path parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, '.');)
    if (!part.empty() && part.find_first_not_of("0123456789") != std::string::npos)
      parts.push_back(part);
  return parts;
}

bool ends_with(const Path& path, const Path& end) {
  return path.size() >= end.size() && std::equal(end.rbegin(), end.rend(), path.rbegin());
}

/// Explains every location in every kind of case whose path ends with `key` ("damage.count.max",
/// "count.max", "max", "/damage/count/max"): meaning, allowed values, and keys. Throws Failure
/// (usage), with the nearest key, if there is no such location.
std::string explanation(const std::string& key) {
  const std::vector<KeyPlace> places = key_places(schema_names());
  const Path asked = parts_of(key);
  std::string text;
  for (const KeyPlace& place : places) {
    if (asked.empty() || !ends_with(place.path, asked)) continue;
    std::string where, kinds;
    for (const std::string& part : place.path) where += "/" + part;
    for (const std::string& kind : place.kinds) kinds += (kinds.empty() ? "" : ", ") + kind;
    text += where + "  (" + kinds + ")\n";
    if (!place.meaning.empty()) text += "    " + place.meaning + "\n";
    if (!place.form.empty()) text += "    " + place.form + "\n";
    if (!place.keys.empty())
      text += "    keys: " + listed({place.keys.begin(), place.keys.end()}) + "\n";
  }
  if (!text.empty()) return text;
  const std::string word = asked.empty() ? key : asked.back();
  std::vector<std::string> names;
  std::set<std::string> mentions;  // keys whose descriptions contain the word
  for (const KeyPlace& place : places) {
    names.push_back(place.path.back());
    if (word.size() > 2 && place.meaning.find(word) != std::string::npos)
      mentions.insert(place.path.back());
  }
  const std::string meant = nearest(word, names);
  std::string instead = meant.empty() ? "" : "; did you mean \"" + meant + "\"?";
  if (!mentions.empty())
    instead += (meant.empty() ? ". " : " ") + std::string("These keys mention the word: ") +
               listed({mentions.begin(), mentions.end()});
  throw Failure(Exit::usage, "there is no key \"" + key + "\"" + instead);
}

}  // namespace

Command explain_command() {
  const auto key = std::make_shared<std::string>();
  return {.name = "explain",
          .summary = "explain a key of a case and its allowed values",
          .add_options =
              [key](CommandOptions& options) {
                options.app()
                    .add_option("KEY", *key, "key of a case, e.g. count.max or /data/cov")
                    ->required();
              },
          .run = [key](const Invocation&) { std::cout << explanation(*key); }};
}

}  // namespace wheeltap::apps
