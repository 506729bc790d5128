#include "apps/cases/syntax/key_places.hpp"

#include <algorithm>
#include <map>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {
namespace {

using Path = std::vector<std::string>;

class Places {
 public:
  explicit Places(std::vector<KeyPlace>& out) : out_(out) {}

  void of_schema(const std::string& kind) {
    kind_ = kind;
    root_ = schema(kind);
    walk(root_, {}, {}, {});
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

  /// `within` holds the references followed so far, to detect recursion.
  void walk(const Json& rule, const Path& path, const std::string& shown,
            std::set<std::string> within) {
    if (rule.contains("$ref")) {
      const std::string name = rule["$ref"].get<std::string>();
      if (!within.insert(name).second) return;
      return walk(root_.at(Pointer(name.substr(1))), path, shown, std::move(within));
    }
    if (!path.empty()) note(rule, path, shown);
    for (const Json& alternative : rule.value("anyOf", Json::array()))
      walk(alternative, path, shown, within);
    if (rule.contains("items") && rule["items"].is_object())
      walk(rule["items"], path, shown + "/N", within);
    const Json others = rule.value("additionalProperties", Json());
    if (others.is_object()) walk(others, path, shown + "/NAME", within);
    const Json properties = rule.value("properties", Json::object());
    for (const auto& [key, inner] : properties.items()) {
      if (KeyPlace* here = path.empty() ? nullptr : find(path)) here->keys.insert(key);
      Path longer = path;
      longer.push_back(key);
      walk(inner, longer, shown + "/" + key, within);
    }
  }

  // An entry of this kind of case.
  KeyPlace* find(const Path& path) {
    const auto found = std::ranges::find_if(out_, [&](const KeyPlace& place) {
      return place.path == path && std::ranges::find(place.kinds, kind_) != place.kinds.end();
    });
    return found == out_.end() ? nullptr : &*found;
  }

  // An entry of another kind of case with the same meaning.
  KeyPlace* find_like(const Path& path, const std::string& meaning) {
    const auto found = std::ranges::find_if(out_, [&](const KeyPlace& place) {
      return place.path == path &&
             (meaning.empty() || place.meaning.empty() || place.meaning == meaning);
    });
    return found == out_.end() ? nullptr : &*found;
  }

  void note(const Json& rule, const Path& path, const std::string& shown) {
    const std::string meaning = rule.value("description", "");
    KeyPlace* here = find(path);
    if (here == nullptr) here = find_like(path, meaning);
    if (here == nullptr) {
      out_.push_back({.path = path, .shown = shown, .meaning = {}, .form = {}});
      here = &out_.back();
    }
    if (here->meaning.empty()) here->meaning = meaning;
    if (here->form.empty()) here->form = form_of(rule);
    if (std::ranges::find(here->kinds, kind_) == here->kinds.end()) here->kinds.push_back(kind_);
  }

  std::vector<KeyPlace>& out_;
  std::string kind_;
  Json root_;
};

}  // namespace

std::vector<KeyPlace> key_places(const std::vector<std::string>& kinds) {
  std::vector<KeyPlace> places;
  Places finder(places);
  for (const std::string& kind : kinds) finder.of_schema(kind);
  return places;
}

}  // namespace wheeltap::apps
