#include "apps/cases/syntax/case_file.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "apps/cases/syntax/case_complaint.hpp"
#include "apps/cases/syntax/case_text.hpp"
#include "apps/cases/syntax/schema_lists.hpp"
#include "apps/json_text.hpp"
#include "apps/schema_texts.hpp"
#include "apps/whole_number.hpp"
#include "apps/written_number.hpp"
#include "inference/model/tabulated_prior.hpp"
#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

std::string shortened(const Json& value) {
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

void apply_override(const std::filesystem::path& path, Json& json, const std::string& override) {
  const auto fail = [&](const std::string& why) {
    throw Failure(Exit::usage, "--set " + override + ": " + why);
  };
  const auto equals = override.find('=');
  if (equals == std::string::npos || equals == 0) fail("must read path.to.key=VALUE");
  const std::string value_text = override.substr(equals + 1);
  const std::string path_text = override.substr(0, equals);
  if (path_text.find('/') != std::string::npos &&
      !json.contains(path_text.substr(0, path_text.find('.')))) {
    std::string with_points = path_text;
    std::ranges::replace(with_points, '/', '.');
    if (with_points.starts_with('.')) with_points.erase(0, 1);
    fail("keys are separated by points: write --set " + with_points + "=" + value_text);
  }
  Json value = value_text;
  // Text that is not JSON is a string. Json::accept builds no values, so that deeply nested text is
  // safe.
  if (Json::accept(value_text)) value = parse_json<Json>("--set", value_text);
  std::size_t depth = 0;

  Json* at = &json;
  std::istringstream keys(override.substr(0, equals));
  for (std::string key; std::getline(keys, key, '.');) {
    if (key.empty()) fail("a key is empty");
    if (++depth > kDeepestJson) fail("more than " + std::to_string(kDeepestJson) + " keys deep");
    if (at->is_array()) {
      const auto last = static_cast<std::int64_t>(at->size());
      const auto found = whole_number(key, 0, last);
      if (!found) {
        fail("\"" + key + "\" is not an element of a list of " + std::to_string(at->size()) +
             " in " + path.string());
      }
      const auto index = static_cast<std::size_t>(*found);
      if (index == at->size()) at->push_back(nullptr);
      at = &(*at)[index];
    } else {
      if (!at->is_object()) *at = Json::object();
      at = &(*at)[key];
    }
  }
  *at = std::move(value);
}

const Json& resolved_key(const Json& root, const Json& rule) {
  if (!rule.contains("$ref")) return rule;
  return resolved_key(root, root.at(Pointer(rule["$ref"].get<std::string>().substr(1))));
}

std::string place(const Pointer& where, const std::string& record_place) {
  constexpr std::string_view kRecord = "/record";
  std::string text = where.to_string();
  if (text == kRecord || text.starts_with("/record/")) {
    text.replace(0, kRecord.size(), record_place);
  }
  return text.empty() ? "/" : text;
}

constexpr std::size_t kLongestText = 4096;  // bytes; notes may be longer

// Keys and texts must be printable UTF-8; notes may have several lines.
void check_texts(const CaseFile& file, const Json& value, const Pointer& where) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) check_texts(file, value[i], where / i);
  } else if (value.is_object()) {
    for (const auto& [key, item] : value.items()) {
      if (io::first_unprintable(key)) {
        file.refuse(where / key, "a key contains a control character, or bytes that are not UTF-8");
      }
      check_texts(file, item, where / key);
    }
  } else if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    const bool notes = where.to_string().starts_with("/notes");
    if (const auto at = io::first_unprintable(text, notes ? "\n\t" : "")) {
      file.refuse(where, "holds a control character, or bytes that are not UTF-8, at byte " +
                             std::to_string(*at + 1));
    }
    if (text.size() > kLongestText && !notes) {
      file.refuse(where, "has " + std::to_string(text.size()) + " bytes, must have at most " +
                             std::to_string(kLongestText));
    }
  }
}

// Numbers like 5.0 become integers where the schema expects integers.
void make_whole(const Json& root, const Json& reference, Json& value) {
  const Json& rule = resolved_key(root, reference);
  for (const Json& alternative : rule.value("anyOf", Json::array())) {
    make_whole(root, alternative, value);
  }
  if (value.is_number_float()) {
    const Json type = rule.value("type", Json());
    if (type == "integer" || (type.is_array() && std::ranges::find(type, "integer") != type.end() &&
                              std::ranges::find(type, "number") == type.end())) {
      constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
      if (const auto n = whole_number(value.get<double>(), -kMost, kMost)) value = *n;
    }
  } else if (value.is_array() && rule.contains("items")) {
    for (Json& item : value) make_whole(root, rule["items"], item);
  } else if (value.is_object()) {
    for (auto& [key, item] : value.items()) {
      if (rule.contains("properties") && rule["properties"].contains(key)) {
        make_whole(root, rule["properties"][key], item);
      } else if (rule.contains("additionalProperties") &&
                 rule["additionalProperties"].is_object()) {
        make_whole(root, rule["additionalProperties"], item);
      }
    }
  }
}

}  // namespace

void CaseFile::refuse(const Pointer& where, const std::string& message) const {
  const std::string pointer = place(where, record_place);
  std::string reason = message;
  if (json.contains(where) && !json.at(where).is_object())
    reason = shortened(json.at(where)) + ": " + message;
  throw Failure(Exit::bad_input, io::printable(path.string() + ": " + pointer + ": " + reason),
                CasePlace{.pointer = pointer, .reason = io::printable(reason)});
}

std::filesystem::path CaseFile::place_of(const std::string& name) const {
  std::filesystem::path beside = path.parent_path() / name;
  std::error_code ignored;
  if (!std::filesystem::exists(beside, ignored) && std::filesystem::exists(name, ignored)) {
    return name;
  }
  return beside;
}

std::filesystem::path CaseFile::resolve(const std::string& name) const {
  std::filesystem::path place = place_of(name);
  inputs->add(name, place);
  return place;
}

CaseFile read_case(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  std::string text;
  try {
    text = io::read_bytes(path, kLargestCase);
  } catch (const io::FileError& error) {
    throw Failure(error.kind() == io::FileError::Kind::missing ? Exit::no_input : Exit::bad_input,
                  error.what());
  }
  return parse_case(path, text, overrides);
}

CaseFile parse_case(const std::filesystem::path& path, const std::string& text,
                    const std::vector<std::string>& overrides) {
  CaseFile file{.path = path, .json = parse_json<Json>(path, text)};
  if (!file.json.is_object()) {
    throw Failure(Exit::bad_input, path.string() + ": /: must be an object, not of the type " +
                                       std::string(file.json.type_name()));
  }
  for (const std::string& override : overrides) apply_override(path, file.json, override);
  check_texts(file, file.json, Pointer());
  return file;
}

std::string identity_of(const CaseFile& file) {
  return file.json.dump() + file.inputs->json().dump();
}

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const auto& [name, text] : kSchemaTexts) {
    if (name != "common" && name != "sample") names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> kinds_with_schema() {
  std::vector<std::string> kinds = schema_names();
  std::erase_if(kinds, [](const auto& name) { return name == "section" || name == "structure"; });
  return kinds;
}

Json schema(std::string_view name) {
  const auto find = [](std::string_view wanted) -> std::optional<Json> {
    for (const auto& [n, text] : kSchemaTexts) {
      if (n == wanted) return Json::parse(text);
    }
    return {};
  };
  auto found = name == "common" ? std::nullopt : find(name);
  if (!found) {
    std::string list;
    for (const auto& n : schema_names()) list += (list.empty() ? "" : ", ") + n;
    throw Failure(Exit::usage,
                  "no schema has the name \"" + std::string(name) + "\"; there are: " + list);
  }
  const Json own = found->at("definitions");  // own definitions replace shared ones of equal name
  for (const std::string& other : definitions_of(name))
    (*found)["definitions"].update(find(other)->at("definitions"));
  (*found)["definitions"].update(own);
  fill_lists(*found);
  add_laws(*found);
  add_residual_models(*found);
  add_defects(*found);
  bound_integers(*found);
  return *found;
}

namespace {

/// Checks the kind first: messages about missing keys would mislead if the kind is wrong.
void require_kind(const CaseFile& file, const Json& rules) {
  const Json::json_pointer allowed("/properties/kind/enum");
  if (!rules.contains(allowed) || !file.json.contains("kind")) return;
  const Json& kind = file.json["kind"];
  if (!kind.is_string() || std::ranges::find(rules.at(allowed), kind) != rules.at(allowed).end())
    return;
  std::string text;
  for (const Json& one : rules.at(allowed))
    text += (text.empty() ? "must be " : " or ") + one.dump();
  for (const std::string& command : kinds_with_schema())
    if (kind == command)
      text += ": the command for this case is `wheeltap " + kind.get<std::string>() + "`";
  file.refuse(Pointer("/kind"), text);
}

}  // namespace

void validate_against_schema(CaseFile& file, std::string_view schema_name) {
  const Json rules = schema(schema_name);
  require_kind(file, rules);
  make_whole(rules, rules, file.json);
  valijson::Schema compiled;
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(rules), compiled);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(compiled, valijson::adapters::NlohmannJsonAdapter(file.json), &results)) {
    return;
  }
  if (const auto complaint = first_complaint(rules, std::string(schema_name), file.json)) {
    file.refuse(complaint->where, complaint->message);
  }
  valijson::ValidationResults::Error error;
  results.popError(error);
  // Converts "<root>[data][modes]" of the validator to /data/modes.
  std::string where;
  for (const std::string& part : error.context) {
    if (part.size() > 2 && part.front() == '[') where += "/" + part.substr(1, part.size() - 2);
  }
  if (where.empty()) where = "/";
  throw Failure(Exit::bad_input, file.path.string() + ": " + where + ": " + error.description,
                CasePlace{.pointer = where, .reason = error.description});
}

inference::Prior parse_prior(const CaseFile& file, const Pointer& where) {
  const Json& prior = file.json.at(where);
  std::string family;
  for (const auto& [key, ignored] : prior.items()) {
    if (key == "on") continue;
    if (!family.empty()) {
      file.refuse(where, "a prior has one family, but this one has both \"" + family + "\" and \"" +
                             key + "\"");
    }
    family = key;
  }
  if (prior.contains("on") && family != "beta") {
    file.refuse(where / "on", "is allowed with \"beta\" only");
  }
  const auto arguments = [&](std::size_t n) {
    const Json& list = prior.at(family);
    if (list.is_number() && n == 1) return std::vector<double>{list.get<double>()};
    auto numbers = list.get<std::vector<double>>();
    if (numbers.size() != n)
      throw std::invalid_argument("has " + std::to_string(numbers.size()) + " numbers, must have " +
                                  std::to_string(n));
    return numbers;
  };
  try {
    using namespace inference;
    if (family == "half_normal") return Prior(HalfNormal{arguments(1)[0]});
    if (family == "truncated_normal") {
      const auto a = arguments(4);
      return Prior(TruncatedNormal{a[0], a[1], a[2], a[3]});
    }
    if (family == "student_t") {
      const auto a = arguments(3);
      return Prior(StudentT{a[0], a[1], a[2]});
    }
    if (family == "table") {
      const Json& table = prior.at(family);
      return Prior(OwnPrior{
          std::make_shared<TabulatedPrior>(table.at("x").get<std::vector<double>>(),
                                           table.at("density").get<std::vector<double>>())});
    }
    const auto a = arguments(2);
    if (family == "uniform") return Prior(Uniform{a[0], a[1]});
    if (family == "log_uniform") return Prior(LogUniform{a[0], a[1]});
    if (family == "normal") return Prior(Normal{a[0], a[1]});
    if (family == "log_normal") return Prior(LogNormal{a[0], a[1]});
    if (family == "gamma") return Prior(Gamma{a[0], a[1]});
    if (family == "inverse_gamma") return Prior(InverseGamma{a[0], a[1]});
    const auto on = prior.value("on", std::vector<double>{0.0, 1.0});
    if (family != "beta" || on.size() != 2) throw std::invalid_argument("is not a prior");
    return Prior(Beta{a[0], a[1], on[0], on[1]});
  } catch (const std::invalid_argument& error) {
    const Json& list = prior.at(family);
    const bool reversed = (family == "uniform" || family == "log_uniform") && list.is_array() &&
                          list.size() == 2 && list[0] > list[1];
    file.refuse(where / family,
                error.what() + (reversed ? "; write [" + pasted(list[1].get<double>()) + ", " +
                                               pasted(list[0].get<double>()) + "]"
                                         : std::string()));
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::string text_or_number(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace wheeltap::apps
