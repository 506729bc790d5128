// Case files: JSON text, changed by --set and validated against a JSON Schema before a run.
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
/// Location in a case, e.g. /beam/material/poisson.
using Pointer = Json::json_pointer;

/// The content of a case file, with the information that error messages need.
struct CaseFile {
  std::filesystem::path path;
  Json json;
  /// Location of the record in the file; error messages show it in place of /record.
  std::string record_place = "/record";
  /// Input files resolved so far, with their fingerprints. Copies of the case share this list.
  std::shared_ptr<InputFiles> inputs = std::make_shared<InputFiles>();

  /// Throws Failure (65) with the text "FILE: /pointer: VALUE: message". VALUE is the value at the
  /// location `where`.
  [[noreturn]] void refuse(const Pointer& where, const std::string& message) const;

  /// Path of a file that the case names: in the folder of the case or, if the file is not there, in
  /// the current folder.
  [[nodiscard]] std::filesystem::path place_of(const std::string& name) const;
  /// The path of an input file. The fingerprint of the file is added to `inputs`.
  [[nodiscard]] std::filesystem::path resolve(const std::string& name) const;
};

/// Reads a file and applies `overrides`, each "path.to.key=VALUE". Array elements are numbered
/// from 0. VALUE is JSON or, if it is not valid JSON, a string. Throws Failure: 66 for an
/// unreadable file; 65, with line and column, for text that is not JSON; 65 for keys and strings
/// that are not UTF-8 or contain control characters; 64 for an override that is not
/// path.to.key=VALUE. An override may add a key.
[[nodiscard]] CaseFile read_case(const std::filesystem::path& path,
                                 const std::vector<std::string>& overrides = {});

/// Text that identifies a case in its results: its JSON and the fingerprints of its input files.
[[nodiscard]] std::string identity_of(const CaseFile& file);

/// Names of all schemas.
[[nodiscard]] std::vector<std::string> schema_names();
/// Kinds of complete cases that have a schema. A command with the same name as the kind runs the
/// cases of this kind.
[[nodiscard]] std::vector<std::string> kinds_with_schema();
/// The JSON Schema (draft 7) of this name, with shared definitions. Throws Failure (64) for an
/// unknown name.
[[nodiscard]] Json schema(std::string_view name);

/// Validates the case against its schema; 5.0 becomes 5 where the schema expects a whole number.
/// Throws Failure (65) with the first fault.
void validate_against_schema(CaseFile& file, std::string_view schema_name);

/// Parses the prior at `where`. Throws Failure (65) if the prior is improper.
[[nodiscard]] inference::Prior parse_prior(const CaseFile& file, const Pointer& where);

/// The names as a list, "a, b, c", or "none".
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// A value as text: strings are returned unchanged, other values (e.g. a column's number) are
/// converted to JSON.
[[nodiscard]] std::string text_or_number(const Json& value);

}  // namespace wheeltap::apps
