#include "apps/explain.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "apps/case_file.hpp"
#include "apps/nearest.hpp"

namespace wheeltap::apps {
namespace {

using Path = std::vector<std::string>;

/// What stands at a place, in the order in which places are met.
struct Place {
  Path path;
  std::string meaning, form;
  std::set<std::string> keys = {};
  std::vector<std::string> kinds = {};  ///< of case
};

class Places {
 public:
  explicit Places(std::vector<Place>& out) : out_(out) {}

  void of_schema(const std::string& kind) {
    kind_ = kind;
    root_ = schema(kind);
    walk(root_, {}, {});
  }

 private:
  static std::string form_of(const Json& rule) {
    std::string form;
    const auto add = [&](const std::string& text) { form += (form.empty() ? "" : ", ") + text; };
    if (rule.contains("enum")) {
      std::string values;
      for (const Json& value : rule["enum"])
        values += (values.empty() ? "" : " or ") + value.dump();
      add(values);
    } else if (rule.contains("type")) {
      std::string types;
      for (const Json& type : rule["type"].is_array() ? rule["type"] : Json::array({rule["type"]}))
        types += (types.empty() ? "" : " or ") + type.get<std::string>();
      add(types);
    }
    for (const auto& [name, sign] : std::map<std::string, std::string>{{"minimum", ">= "},
                                                                       {"exclusiveMinimum", "> "},
                                                                       {"maximum", "<= "},
                                                                       {"exclusiveMaximum", "< "}})
      if (rule.contains(name)) add(sign + rule[name].dump());
    return form;
  }

  /// `within`: references on the way here, which may lead round.
  void walk(const Json& rule, const Path& path, std::set<std::string> within) {
    if (rule.contains("$ref")) {
      const std::string name = rule["$ref"];
      if (!within.insert(name).second) return;
      return walk(root_.at(Pointer(name.substr(1))), path, std::move(within));
    }
    if (!path.empty()) note(rule, path);
    for (const Json& alternative : rule.value("anyOf", Json::array()))
      walk(alternative, path, within);
    if (rule.contains("items") && rule["items"].is_object()) walk(rule["items"], path, within);
    const Json others = rule.value("additionalProperties", Json());
    if (others.is_object()) walk(others, path, within);
    const Json properties = rule.value("properties", Json::object());
    for (const auto& [key, inner] : properties.items()) {
      if (Place* here = path.empty() ? nullptr : find(path)) here->keys.insert(key);
      Path longer = path;
      longer.push_back(key);
      walk(inner, longer, within);
    }
  }

  // Of this kind of case.
  Place* find(const Path& path) {
    const auto found = std::ranges::find_if(out_, [&](const Place& place) {
      return place.path == path && std::ranges::find(place.kinds, kind_) != place.kinds.end();
    });
    return found == out_.end() ? nullptr : &*found;
  }

  // Of another kind of case, if it means the same there.
  Place* find_like(const Path& path, const std::string& meaning) {
    const auto found = std::ranges::find_if(out_, [&](const Place& place) {
      return place.path == path &&
             (meaning.empty() || place.meaning.empty() || place.meaning == meaning);
    });
    return found == out_.end() ? nullptr : &*found;
  }

  void note(const Json& rule, const Path& path) {
    const std::string meaning = rule.value("description", "");
    Place* here = find(path);
    if (here == nullptr) here = find_like(path, meaning);
    if (here == nullptr) {
      out_.push_back({.path = path, .meaning = {}, .form = {}});
      here = &out_.back();
    }
    if (here->meaning.empty()) here->meaning = meaning;
    if (here->form.empty()) here->form = form_of(rule);
    if (std::ranges::find(here->kinds, kind_) == here->kinds.end()) here->kinds.push_back(kind_);
  }

  std::vector<Place>& out_;
  std::string kind_;
  Json root_;
};

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

}  // namespace

std::string explanation(const std::string& key) {
  std::vector<Place> places;
  Places finder(places);
  for (const std::string& kind : schema_names()) finder.of_schema(kind);
  const Path asked = parts_of(key);
  std::string text;
  for (const Place& place : places) {
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
  std::set<std::string> speaking;  // keys whose texts have the word
  for (const Place& place : places) {
    names.push_back(place.path.back());
    if (word.size() > 2 && place.meaning.find(word) != std::string::npos)
      speaking.insert(place.path.back());
  }
  const std::string meant = nearest(word, names);
  std::string instead = meant.empty() ? "" : "; did you mean \"" + meant + "\"?";
  if (!speaking.empty())
    instead += (meant.empty() ? ". " : " ") + std::string("The texts of these speak of it: ") +
               listed({speaking.begin(), speaking.end()});
  throw Failure(Exit::usage, "there is no key \"" + key + "\"" + instead);
}

}  // namespace wheeltap::apps
