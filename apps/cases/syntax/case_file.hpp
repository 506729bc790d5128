// Case files: JSON text, overridden by --set, held against a JSON Schema before anything runs.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cases/syntax/input_files.hpp"
#include "apps/failure.hpp"
#include "inference/model/prior.hpp"

namespace wheeltap::apps {

using Json = nlohmann::json;
/// A place in a case, e.g. /beam/material/poisson.
using Pointer = Json::json_pointer;

/// A case as read, with what is needed to complain about it.
struct CaseFile {
  std::filesystem::path path;
  Json json;
  /// Where /record stands in the file itself: elsewhere for one of several records.
  std::string record_place = "/record";
  /// The files that have been resolved so far, with their content. Copies share it.
  std::shared_ptr<InputFiles> inputs = std::make_shared<InputFiles>();

  /// Throws Failure (65): "FILE: /pointer: VALUE: message", the value being what stands there.
  [[noreturn]] void refuse(const Pointer& where, const std::string& message) const;

  /// Where a name in the case leads: to the case's own folder or, where it is not there, to the
  /// current one.
  [[nodiscard]] std::filesystem::path place_of(const std::string& name) const;
  /// The same of a file that is to be read: its content is recorded in `inputs`.
  [[nodiscard]] std::filesystem::path resolve(const std::string& name) const;
};

/// Reads FILE and applies `overrides`, each "path.to.key=VALUE" (array elements by 0-based number;
/// VALUE is JSON, or else taken as text). Throws Failure: 66 for a file that cannot be read, 65
/// with line and column for text that is not JSON, 65 for keys and texts that are not UTF-8 or
/// that hold control characters, 64 for an override that leads nowhere.
[[nodiscard]] CaseFile read_case(const std::filesystem::path& path,
                                 const std::vector<std::string>& overrides = {});

/// The case and the content of the files that it has resolved, as text: what results belong to.
[[nodiscard]] std::string identity_of(const CaseFile& file);

/// Kinds of case that have a schema.
[[nodiscard]] std::vector<std::string> schema_names();
/// Those of them whose name is the kind of a whole case, which the command of that name runs.
[[nodiscard]] std::vector<std::string> kinds_with_schema();
/// The JSON Schema (draft 7) of a kind of case, its shared definitions included. Throws Failure
/// (64) for another name.
[[nodiscard]] Json schema(std::string_view name);

/// Holds the case against its schema; 5.0 becomes 5 where that wants whole numbers. Throws Failure
/// (65) with the first complaint, worded for the case's author.
void validate_against_schema(CaseFile& file, std::string_view schema_name);

/// The prior written at `where`. Throws Failure (65) where it is improper.
[[nodiscard]] inference::Prior parse_prior(const CaseFile& file, const Pointer& where);

/// "a, b, c", or "none".
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// A text as it is; anything else as JSON, e.g. a column's number.
[[nodiscard]] std::string text_or_number(const Json& value);

}  // namespace wheeltap::apps
