// Where the schemas of cases allow which keys.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace wheeltap::apps {

/// A place of a case and what may stand there.
struct KeyPlace {
  std::vector<std::string> path;  ///< keys, without names that the author chooses
  std::string shown;              ///< as a pointer: "/models/N/masses", "/parameters/NAME"
  std::string meaning, form;
  std::set<std::string> keys = {};
  std::vector<std::string> kinds = {};  ///< of case
};

/// The places of these kinds of case (schema_names), in the order of the schemas. Kinds in which a
/// place means the same share it.
[[nodiscard]] std::vector<KeyPlace> key_places(const std::vector<std::string>& kinds);

}  // namespace wheeltap::apps
