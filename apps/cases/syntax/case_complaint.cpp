#include "apps/cases/syntax/case_complaint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/cases/syntax/key_places.hpp"
#include "apps/nearest.hpp"
#include "apps/written_number.hpp"

namespace wheeltap::apps {
namespace {

/// Names that engineers and other programs use for keys of a case, in lower case.
constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
    {"e", "young"},
    {"youngs_modulus", "young"},
    {"elastic_modulus", "young"},
    {"e_modulus", "young"},
    {"modulus", "young"},
    {"nu", "poisson"},
    {"rho", "density"},
    {"l", "length"},
    {"b", "width"},
    {"h", "height"},
    {"d", "diameter"},
    {"t", "thickness"},
    {"a", "area"},
    {"i", "second_moment"},
    {"inertia", "second_moment"},
    {"type", "kind"},
    {"type", "shape"},
    {"n_elements", "elements"},
    {"mesh", "elements"},
    {"boundary_conditions", "supports"},
    {"bc", "supports"},
    {"bcs", "supports"},
    {"constraints", "supports"},
    {"freq", "frequencies"},
    {"freqs", "frequencies"},
    {"f", "frequencies"},
    {"natural_frequencies", "frequencies"},
    {"coefficient_of_variation", "cov"},
    {"sigma", "sd"},
    {"std", "sd"},
    {"stdev", "sd"},
    {"fs", "sample_rate"},
    {"sampling_rate", "sample_rate"},
    {"sampling_frequency", "sample_rate"},
    {"samplerate", "sample_rate"},
    {"rate", "sample_rate"},
    {"mode_shapes", "shapes"},
    {"accelerometers", "sensors"},
    {"position", "location"},
    {"severity", "reduction"},
    {"loss", "reduction"},
    {"stiffness_loss", "reduction"},
    {"gaussian", "normal"},
    {"norm", "normal"},
    {"flat", "uniform"},
    {"lognormal", "log_normal"},
    {"jeffreys", "log_uniform"},
    {"reciprocal", "log_uniform"},
    {"k", "stiffness"},
    {"c", "damping"},
    {"m", "masses"},
    {"m", "mass"},
    {"dof", "mass"},
    {"name", "column"},
    {"channel", "column"},
    {"column_name", "column"},
    {"nodes", "between"},
    {"from", "between"},
    {"path", "file"},
    {"filename", "file"},
    {"data_file", "file"},
    {"data", "record"},
    {"direction", "fix"},
    {"dofs", "fix"},
    {"priors", "parameters"},
    {"variables", "parameters"},
    {"description", "notes"},
    {"comment", "notes"},
    {"comments", "notes"},
    {"units", "unit"},
};

constexpr std::size_t kLongestCorrection = 200;  // bytes

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ' || c == '-') c = '_';
  }
  return text;
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "number") return value.is_number();
  if (type == "integer") {
    return value.is_number_integer() ||
           (value.is_number_float() && std::trunc(value.get<double>()) == value.get<double>());
  }
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "array") return value.is_array();
  if (type == "object") return value.is_object();
  return value.is_null();
}

bool type_matches(const Json& rule, const Json& value) {
  if (!rule.contains("type")) return true;
  if (rule["type"].is_string()) return has_type(value, rule["type"].get<std::string>());
  return std::ranges::any_of(rule["type"],
                             [&](const Json& t) { return has_type(value, t.get<std::string>()); });
}

std::string listed_values(const Json& list) {
  std::string text;
  for (const Json& item : list) text += (text.empty() ? "" : ", ") + item.dump();
  return text;
}

std::string article(const std::string& type) {
  if (type == "array") return "a list";
  return (std::string("aeio").find(type[0]) != std::string::npos ? "an " : "a ") + type;
}

/// Text on the valid values of a rule: the description in the schema, if the rule has one.
std::string rule_in_words(const Json& rule) {
  if (rule.contains("description")) return rule["description"].get<std::string>();
  if (rule.contains("enum")) {
    return (rule["enum"].size() > 1 ? "one of " : "") + listed_values(rule["enum"]);
  }
  if (!rule.contains("type")) return "something else";
  if (rule["type"].is_string()) return article(rule["type"].get<std::string>());
  std::string text;
  for (const Json& t : rule["type"])
    text += (text.empty() ? "" : " or ") + article(t.get<std::string>());
  return text;
}

/// JSON text with numbers in their shortest form.
std::string as_written(const Json& value) {
  if (value.is_number_float()) return pasted(value.get<double>());
  if (value.is_array()) {
    std::string text;
    for (const Json& item : value) text += (text.empty() ? "[" : ", ") + as_written(item);
    return text.empty() ? "[]" : text + "]";
  }
  if (value.is_object()) {
    std::string text;
    for (const auto& [key, item] : value.items())
      text += (text.empty() ? "{" : ", ") + Json(key).dump() + ": " + as_written(item);
    return text.empty() ? "{}" : text + "}";
  }
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool is_placeholder(const std::string& text) {
  static constexpr std::array kWords = {"", "-", "--", "nan", "n/a", "na", "none", "null", "?"};
  const std::string small = lower_case(text);
  return std::ranges::find(kWords, small) != kWords.end() || small == "_" || small == "__";
}

/// Converts "13.85, 55.4" and "13.85 55.4" to a list; null for other texts.
Json list_of_numbers(std::string text) {
  const char between = text.find(';') != std::string::npos   ? ';'
                       : text.find(',') != std::string::npos ? ','
                                                             : ' ';
  std::erase(text, '[');
  std::erase(text, ']');
  std::istringstream stream(text);
  Json list = Json::array();
  for (std::string part; std::getline(stream, part, between);) {
    if (part.find_first_not_of(' ') == std::string::npos) continue;
    const auto number = written_number(part);
    if (!number) return {};
    list.push_back(number->value);
  }
  return list.size() > 1 ? list : Json();
}

Json uniform_prior(const Json& bounds) {
  Json prior = Json::object();
  prior["uniform"] = bounds;
  return prior;
}

/// The two numbers of {"min": 0, "max": 1} and similar objects, in order; null for other objects.
Json pair_of(const Json& object) {
  if (object.size() != 2) return {};
  static constexpr std::array kFirst = {"min",  "low", "lower", "a",   "mean", "mu",
                                        "from", "lo",  "shape", "loc", "left"};
  Json first, second;
  for (const auto& [key, value] : object.items()) {
    if (!value.is_number()) return {};
    (std::ranges::find(kFirst, lower_case(key)) != kFirst.end() ? first : second) = value;
  }
  return first.is_null() || second.is_null() ? Json() : Json::array({first, second});
}

class Examination {
 public:
  Examination(const Json& root, std::string kind) : root_(root), kind_(std::move(kind)) {}

  std::optional<Complaint> explain(const Json& reference, const Json& value,
                                   const Pointer& where) const {
    const Json& rule = resolved(reference);
    const auto complain = [&](const std::string& message) {
      return Complaint{where, message + instead(rule, value, where)};
    };

    if (rule.contains("anyOf")) {
      std::vector<const Json*> fitting;
      for (const Json& alternative : rule["anyOf"]) {
        const Json& candidate = resolved(alternative);
        if (!explain(candidate, value, where)) return {};
        if (type_matches(candidate, value) && (value.is_object() || value.is_array() ||
                                               (value.is_number() && candidate.contains("type")))) {
          fitting.push_back(&candidate);
        }
      }
      // The kind of an object follows from the required keys in the object.
      const auto named = [&](const Json* candidate) {
        const Json required = candidate->value("required", Json::array());
        return value.is_object() && !required.empty() &&
               std::ranges::all_of(required, [&](const Json& key) {
                 return value.contains(key.get<std::string>());
               });
      };
      if (fitting.size() > 1) {
        if (std::ranges::any_of(fitting, named)) {
          std::erase_if(fitting, [&](const Json* candidate) { return !named(candidate); });
        } else {
          std::erase_if(fitting,
                        [](const Json* candidate) { return candidate->contains("x-named"); });
        }
      }
      if (fitting.size() == 1) return explain(*fitting[0], value, where);
      return complain("must be " + rule_in_words(rule));
    }
    if (!type_matches(rule, value)) return complain("must be " + rule_in_words(rule));
    if (rule.contains("enum") && std::ranges::find(rule["enum"], value) == rule["enum"].end()) {
      return complain("must be " + (rule["enum"].size() > 1
                                        ? "one of " + listed_values(rule["enum"])
                                        : listed_values(rule["enum"])));
    }
    if (value.is_number()) {
      const double x = value.get<double>();
      const std::string unit =
          rule.contains("description") ? " (" + rule["description"].get<std::string>() + ")" : "";
      if (rule.contains("minimum") && !(x >= rule["minimum"].get<double>())) {
        return complain("must be >= " + rule["minimum"].dump() + unit);
      }
      if (rule.contains("exclusiveMinimum") && !(x > rule["exclusiveMinimum"].get<double>())) {
        return complain("must be > " + rule["exclusiveMinimum"].dump() + unit);
      }
      if (rule.contains("maximum") && !(x <= rule["maximum"].get<double>())) {
        return complain("must be <= " + rule["maximum"].dump() + unit);
      }
      if (rule.contains("exclusiveMaximum") && !(x < rule["exclusiveMaximum"].get<double>())) {
        return complain("must be < " + rule["exclusiveMaximum"].dump() + unit);
      }
    }
    if (value.is_string() && rule.contains("minLength") &&
        value.get<std::string>().size() < rule["minLength"].get<std::size_t>()) {
      return complain("must not be empty");
    }
    if (value.is_array()) {
      const std::string many = " elements, has " + std::to_string(value.size());
      if (rule.value("minItems", 0) == 1 && value.empty())
        return complain("is empty: must have at least one element" + meaning(rule));
      if (rule.contains("minItems") && value.size() < rule["minItems"].get<std::size_t>()) {
        return complain("must have at least " + rule["minItems"].dump() + many + meaning(rule));
      }
      if (rule.contains("maxItems") && value.size() > rule["maxItems"].get<std::size_t>()) {
        return complain("must have at most " + rule["maxItems"].dump() + many + meaning(rule));
      }
      if (rule.contains("items")) {
        for (std::size_t i = 0; i < value.size(); ++i) {
          if (auto c = explain(rule["items"], value[i], where / i)) return c;
        }
      }
    }
    if (value.is_object()) return of_keys(rule, value, where);
    return {};
  }

 private:
  const Json& resolved(const Json& rule) const {
    if (!rule.contains("$ref")) return rule;
    return resolved(root_.at(Pointer(rule["$ref"].get<std::string>().substr(1))));
  }

  static std::string meaning(const Json& rule) {
    return rule.contains("description") ? " (" + rule["description"].get<std::string>() + ")" : "";
  }

  std::optional<Complaint> of_keys(const Json& rule, const Json& value,
                                   const Pointer& where) const {
    const Json properties = rule.value("properties", Json::object());
    const Json others = rule.value("additionalProperties", Json(true));
    if (others == false) {
      for (const auto& [key, ignored] : value.items()) {
        if (!properties.contains(key))
          return Complaint{where / key, unknown_key(key, where, rule, value)};
      }
    }
    for (const Json& key : rule.value("required", Json::array())) {
      const std::string name = key.get<std::string>();
      if (value.contains(name)) continue;
      const Json& missing = resolved(properties.at(name));
      return Complaint{where / name,
                       "is missing: must be " + rule_in_words(missing) + example(name, missing)};
    }
    if (rule.contains("minProperties") && value.size() < rule["minProperties"].get<std::size_t>()) {
      return Complaint{where, "must be " + rule_in_words(rule)};
    }
    for (const auto& [key, item] : value.items()) {
      if (properties.contains(key)) {
        if (auto c = explain(properties[key], item, where / key)) return c;
      } else if (others.is_object()) {
        if (auto c = explain(others, item, where / key)) return c;
      }
    }
    return {};
  }

  // "; for example "poisson": 0.3": the schema's example, or the only allowed value.
  std::string example(const std::string& key, const Json& rule) const {
    Json value;
    if (rule.contains("examples")) {
      value = rule["examples"][0];
    } else if (rule.contains("enum") && rule["enum"].size() == 1) {
      value = rule["enum"][0];
    } else {
      return {};
    }
    return "; write " + Json(key).dump() + ": " + as_written(value) +
           (rule.contains("examples") ? ", for example" : "");
  }

  std::string unknown_key(const std::string& key, const Pointer& parent, const Json& rule,
                          const Json& object) const {
    const Json properties = rule.value("properties", Json::object());
    std::vector<std::string> names, free;
    for (const auto& [name, ignored] : properties.items()) {
      names.push_back(name);
      if (!object.contains(name)) free.push_back(name);
    }
    const std::string small = lower_case(key);
    std::string meant;
    for (const std::string& name : free)
      if (lower_case(name) == small) meant = name;
    for (const auto& [other, name] : kOtherNames)
      if (meant.empty() && other == small && std::ranges::find(free, name) != free.end())
        meant = name;
    if (meant.empty()) meant = nearest(small, free);
    const std::string hint = rule.value("x-hint", "");
    const std::string elsewhere = places_of(key, parent);
    std::string text = "unknown key";
    if (!elsewhere.empty() && (meant.empty() || edit_distance(small, meant) > 1)) {
      text += ": " + elsewhere;
    } else if (!meant.empty()) {
      text += "; did you mean \"" + meant + "\"?";
    } else if (std::ranges::find(names, nearest(small, names)) != names.end()) {
      text += "; \"" + nearest(small, names) + "\" is given already: remove this key";
    }
    return text + " (allowed here: " + listed(names) + ")" + (hint.empty() ? "" : "; " + hint);
  }

  /// Text on the location of a key: "it belongs in /data", or the kinds of case that have the key.
  std::string places_of(const std::string& key, const Pointer& parent) const {
    const auto found_in = [&](const std::vector<std::string>& kinds) {
      std::vector<KeyPlace> found;
      for (const KeyPlace& place : key_places(kinds))
        if (place.path.back() == key) found.push_back(place);
      std::ranges::stable_sort(found, {}, [&](const KeyPlace& place) {
        // Nearest first: sort by the part of the path that differs from `parent`, then by length.
        const std::string here = parent.to_string();
        const auto same = std::ranges::mismatch(here, place.shown).in1 - here.begin();
        return std::pair(static_cast<std::ptrdiff_t>(place.path.size()) - (same > 1 ? 1 : 0),
                         place.path.size());
      });
      return found;
    };
    const auto parent_of = [](const KeyPlace& place) {
      const std::string up = place.shown.substr(0, place.shown.rfind('/'));
      return up.empty() ? std::string("the case itself, beside \"kind\"") : up;
    };
    const std::vector<KeyPlace> here = found_in({kind_});
    if (!here.empty()) {
      std::string text = "it belongs in " + parent_of(here[0]);
      if (here.size() > 1 && here[1].path.size() == here[0].path.size())
        text += " or " + parent_of(here[1]);
      return text;
    }
    for (const std::string& kind : kinds_with_schema()) {
      if (kind == kind_) continue;
      const std::vector<KeyPlace> there = found_in({kind});
      if (!there.empty() && there[0].path.size() == 1)
        return "this key belongs to cases of the kind \"" + kind + "\"";
    }
    return {};
  }

  /// Values that the user may have intended by `value`.
  std::vector<Json> meant_by(const Json& rule, const Json& value) const {
    std::vector<Json> list;
    if (value.is_string()) {
      const auto& text = value.get_ref<const std::string&>();
      if (is_placeholder(text)) list.emplace_back(nullptr);
      if (const auto number = written_number(text)) {
        list.emplace_back(number->value);
        list.push_back(Json::array({number->value}));
      }
      list.push_back(list_of_numbers(text));
      const std::string small = lower_case(text);
      if (small == "true" || small == "yes" || small == "on") list.emplace_back(true);
      if (small == "false" || small == "no" || small == "off") list.emplace_back(false);
      list.push_back(Json::array({value}));
      std::vector<std::string> words;
      collect_words(rule, words);
      for (const std::string& word : words)
        if (lower_case(word) == small) list.emplace_back(word);
      if (const std::string word = nearest(small, words); !word.empty()) {
        list.emplace_back(word);
        list.push_back(Json::array({word}));
      }
    } else if (value.is_number()) {
      const double x = value.get<double>();
      if (x == 0.0) list.emplace_back(nullptr);
      list.push_back(Json::array({value}));
      list.push_back(Json::array({Json::array({value})}));
      if (!accepts_numbers(rule)) list.emplace_back(text_or_number(value));
      if (x > 1.0 && x <= 100.0) list.emplace_back(x / 100.0);
      if (value.is_number_float() && std::abs(x) < 1e9) list.emplace_back(std::llround(x));
      if (x > 0.0) list.push_back(uniform_prior(Json::array({x / 2.0, x * 2.0})));
    } else if (value.is_array()) {
      list.push_back(uniform_prior(value));
      if (value.size() == 1) list.push_back(value[0]);
      list.push_back(Json::array({value}));
    } else if (value.is_object()) {
      const Json pair = pair_of(value);
      list.push_back(pair);
      list.push_back(uniform_prior(pair));
      list.push_back(Json::array({value}));
    }
    return list;
  }

  /// True if a rule accepts some numbers; a number that it rejects is then out of range.
  bool accepts_numbers(const Json& reference) const {
    const Json& rule = resolved(reference);
    if (rule.contains("anyOf"))
      return std::ranges::any_of(rule["anyOf"],
                                 [&](const Json& one) { return accepts_numbers(one); });
    return rule.contains("type") && (type_matches(rule, 1.5) || type_matches(rule, 1));
  }

  void collect_words(const Json& reference, std::vector<std::string>& words) const {
    const Json& rule = resolved(reference);
    for (const Json& word : rule.value("enum", Json::array()))
      if (word.is_string()) words.push_back(word.get<std::string>());
    for (const Json& alternative : rule.value("anyOf", Json::array()))
      collect_words(alternative, words);
    if (rule.contains("items") && rule["items"].is_object()) collect_words(rule["items"], words);
  }

  /// "; write …": first intended value that satisfies the rule, else the schema's example.
  std::string instead(const Json& rule, const Json& value, const Pointer& where) const {
    if (correcting_) return {};
    correcting_ = true;
    std::string text = as_parameter(rule, value, where);
    for (const Json& candidate : meant_by(rule, value)) {
      if (!text.empty()) break;
      if (candidate == value) continue;
      if (candidate.is_null() && (value.is_array() || value.is_object())) continue;
      if (explain(rule, candidate, where)) continue;
      if (as_written(candidate).size() > kLongestCorrection) continue;
      text = "; write " + as_written(candidate);
      const bool percent = value.is_number() && candidate.is_number() &&
                           candidate.get<double>() * 100.0 == value.get<double>();
      if (percent) text += " for " + as_written(value) + " %";
      if (value.is_string() && candidate.is_number()) {
        const auto number = written_number(value.get_ref<const std::string&>());
        if (number && !number->unit.empty()) text += " (" + number->unit + ")";
      }
      if (candidate.is_null()) text += " for a mode not measured";
    }
    if (text.empty() && rule.contains("examples"))
      text = "; write " + as_written(rule["examples"][0]) + ", for example";
    correcting_ = false;
    return text;
  }

  /// Advice for a prior instead of a number: the coefficient needs the name of a parameter.
  std::string as_parameter(const Json& rule, const Json& value, const Pointer& where) const {
    const Pointer parameters("/properties/parameters"), prior("/definitions/prior");
    if (!value.is_object() || !type_matches(rule, 1.0) || !type_matches(rule, "name") ||
        where.empty() || !root_.contains(parameters) || !root_.contains(prior) ||
        explain(root_.at(prior), value, where))
      return {};
    std::string name = where.back();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      name = where.parent_pointer().back();
    return "; write \"" + name + "\" here, and \"parameters\": {\"" + name +
           "\": " + as_written(value) + "} in the case";
  }

  const Json& root_;
  std::string kind_;
  mutable bool correcting_ = false;  ///< inside `instead`, whose messages need no correction
};

}  // namespace

std::optional<Complaint> first_complaint(const Json& rules, const std::string& schema_name,
                                         const Json& json) {
  return Examination(rules, schema_name).explain(rules, json, Pointer());
}

}  // namespace wheeltap::apps
