// Insertion of the library's lists (force laws, residual models, defects, interpolants) into
// schemas.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "apps/law_words.hpp"
#include "dynamics/laws.hpp"
#include "identification/emulation/interpolants.hpp"
#include "identification/sid/residuals/residual_model.hpp"
#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::apps {

/// Names of the other schemas whose definitions a kind of case uses, in addition to its own
/// schema.
inline std::vector<std::string> definitions_of(std::string_view kind) {
  if (kind == "update") return {"common", "structure"};
  return {"common"};
}

/// The schema of a force law in a case, generated from the description of the force law. In a case,
/// a force law is an object, a list of objects or, if one coefficient defines it, the value of this
/// coefficient.
template <class AnyJson>
AnyJson law_rule(const dynamics::LawInfo& law) {
  AnyJson object = {{"description", law_in_words(law)}, {"type", AnyJson::array()}};
  if (has_short_form(law)) object["type"] = {"number", "string"};
  object["type"].push_back("object");
  object["properties"] = AnyJson::object();
  object["required"] = AnyJson::array();
  for (int i = 0; i < law.size(); ++i) {
    const dynamics::LawCoefficient& c = law.coefficients[static_cast<std::size_t>(i)];
    AnyJson& key = object["properties"][std::string(c.name)];
    key = {{"description", in_words(c)}, {"type", {"number", "string"}}};
    if (std::isfinite(c.lower)) key[c.above_lower ? "exclusiveMinimum" : "minimum"] = c.lower;
    if (std::isfinite(c.upper)) key["maximum"] = c.upper;
    if (c.required()) object["required"].push_back(std::string(c.name));
  }
  if (law.one_sided) {
    object["properties"]["side"] = {
        {"description",
         "the side on which the law acts: \"opening\" (e > 0) or \"closing\" (e < 0)"},
        {"enum", {"opening", "closing"}}};
    object["required"].push_back("side");
  }
  object["additionalProperties"] = false;
  object["x-hint"] = "`wheeltap laws " + std::string(law.name) + "` explains this law";
  AnyJson rule = object;
  rule["type"].push_back("array");
  rule["minItems"] = 1;
  rule["items"] = std::move(object);
  return rule;
}

/// Adds a key for every force law to the links of a schema that defines links.
template <class AnyJson>
void add_laws(AnyJson& rules) {
  if (!rules.at("definitions").contains("link")) return;
  auto& link = rules["definitions"]["link"];
  for (const dynamics::LawInfo& law : dynamics::law_infos())
    link["properties"][std::string(law.name)] = law_rule<AnyJson>(law);
  link["x-hint"] = "`wheeltap laws` explains the force laws";
}

/// Adds a key for every residual model to a schema that defines residuals.
template <class AnyJson>
void add_residual_models(AnyJson& rules) {
  if (!rules.at("definitions").contains("residuals")) return;
  const auto kinds = identification::residual_kinds();
  auto& object = rules["definitions"]["residuals"];
  std::string description;
  for (const identification::ResidualKind* kind : kinds) {
    description += (description.empty() ? "" : "; ") + std::string(kind->description);
    object["properties"][std::string(kind->key)] = {
        {"description", std::string(kind->value_description)},
        {"anyOf",
         {{{"type", "integer"}, {"minimum", 0}, {"maximum", kind->highest}},
          {{"type", "string"}, {"enum", AnyJson::array({"auto"})}}}}};
  }
  object["description"] = description;
  if (kinds.size() == 1) object["required"].push_back(std::string(kinds.front()->key));
}

/// Adds the types of defect, and a severity key for each type, to a schema that defines defects.
template <class AnyJson>
void add_defects(AnyJson& rules) {
  if (!rules.at("definitions").contains("defects")) return;
  auto& keys = rules["definitions"]["defects"]["properties"];
  auto& of_truth = rules["definitions"]["true_defect"]["properties"];
  // A copy instead of a reference, because inserted keys may relocate existing keys
  AnyJson names = AnyJson::array();
  for (const auto* type : identification::defect_types()) {
    if (!type->is_for_beams()) continue;
    names.push_back(std::string(type->name));
    const std::string severity(type->severity);
    if (!keys.contains(severity)) keys[severity] = {{"$ref", "#/definitions/prior"}};
    if (!of_truth.contains(severity)) {
      of_truth[severity] = {{"description", std::string(type->bounds_words)}, {"type", "number"}};
    }
  }
  keys["kind"]["enum"] = std::move(names);
}

/// Replaces "x-list": "interpolants" in `rules` by an "enum" of interpolant names. The new
/// description also states which interpolants need grids and which accept other designs. `AnyJson`
/// is Json, or ordered_json, which keeps the order of keys.
template <class AnyJson>
void fill_lists(AnyJson& rules) {
  using Runs = emulator::InterpolantType::Runs;
  if (rules.is_object() && rules.contains("x-list") && rules["x-list"] == "interpolants") {
    rules.erase("x-list");
    rules["enum"] = AnyJson::array();
    for (const auto* type : identification::interpolant_types()) {
      rules["enum"].push_back(std::string(type->name));
    }
    rules["description"] =
        rules["description"].template get<std::string>() +
        "; grids: " + identification::interpolant_names(Runs::grid) +
        "; space-filling designs: " + identification::interpolant_names(Runs::scattered);
  }
  for (auto& child : rules) {
    if (child.is_structured()) fill_lists(child);
  }
}

/// Limits whole numbers without a maximum to the range of int, because larger numbers would
/// overflow silently. Seeds may have 63 bits.
template <class AnyJson>
void bound_integers(AnyJson& rules, const std::string& key = {}) {
  const auto whole = [](const AnyJson& type) {
    return type == "integer" || type == AnyJson{"string", "integer"};
  };
  if (rules.is_object() && rules.contains("type") && whole(rules["type"]) &&
      !rules.contains("maximum")) {
    rules["maximum"] = key == "seed" ? 9223372036854775807 : 2147483647;
  }
  if (rules.is_object()) {
    for (auto& [name, child] : rules.items()) {
      if (child.is_structured()) bound_integers(child, name);
    }
  } else {
    for (auto& child : rules) {
      if (child.is_structured()) bound_integers(child, key);
    }
  }
}

}  // namespace wheeltap::apps
