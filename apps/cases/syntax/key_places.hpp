// Locations of keys in the schemas of cases.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace wheeltap::apps {

/// A location in a case and its allowed values.
struct KeyPlace {
  /// Keys of the path, except names that the author of the case chooses
  std::vector<std::string> path;
  std::string shown;  ///< path as a JSON pointer: "/models/N/masses", "/parameters/NAME"
  std::string meaning, form;
  std::set<std::string> keys = {};
  std::vector<std::string> kinds = {};  ///< kinds of case with this key
};

/// The locations of keys in the given kinds of case (schema_names), in the order of the schemas. If
/// a location has the same meaning in several kinds, these kinds share one entry.
[[nodiscard]] std::vector<KeyPlace> key_places(const std::vector<std::string>& kinds);

}  // namespace wheeltap::apps
