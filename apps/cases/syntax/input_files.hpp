// The files that a case reads, and what they held: results belong to them as to the case.
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
  /// Records the content of a regular file under the name that the case gives it, once. What is not
  /// there, or is no regular file, is left to its reader.
  void add(const std::string& name, const std::filesystem::path& path);

  /// A list without names; it need not read again what this one has read.
  [[nodiscard]] InputFiles emptied() const;

  /// {"record.csv": {"bytes": 1234, "checksum": "0123456789abcdef"}, …}, by name.
  [[nodiscard]] nlohmann::json json() const;

 private:
  using Contents = std::map<std::filesystem::path, io::FileFingerprint>;

  std::map<std::string, io::FileFingerprint> files_;
  std::shared_ptr<Contents> read_ = std::make_shared<Contents>();
};

}  // namespace wheeltap::apps
