// Input files of a case, with fingerprints of their content. The fingerprints are part of the text
// that identifies a case in its results (identity_of).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "io/fingerprint.hpp"

namespace wheeltap::apps {

class InputFiles {
 public:
  /// Adds the fingerprint of a regular file, named `name` in the case, unless the list has it
  /// already. Missing files and files of other types are ignored; the function that reads the file
  /// later reports the error.
  void add(const std::string& name, const std::filesystem::path& path);

  /// Returns an empty list that shares the cache of computed fingerprints with this list.
  [[nodiscard]] InputFiles emptied() const;

  /// The fingerprints as JSON, by name: {"record.csv": {"bytes": 1234, "checksum":
  /// "0123456789abcdef"}, …}.
  [[nodiscard]] nlohmann::json json() const;

 private:
  using Contents = std::map<std::filesystem::path, io::FileFingerprint>;

  std::map<std::string, io::FileFingerprint> files_;
  std::shared_ptr<Contents> read_ = std::make_shared<Contents>();
};

}  // namespace wheeltap::apps
