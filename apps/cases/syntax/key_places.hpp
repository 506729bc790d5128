// Places of keys in the schemas of cases.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace wheeltap::apps {

/// A place of a case and its allowed values.
struct KeyPlace {
  std::vector<std::string> path;  ///< keys, without names chosen by the author
  std::string shown;              ///< as a pointer: "/models/N/masses", "/parameters/NAME"
  std::string meaning, form;
  std::set<std::string> keys = {};
  std::vector<std::string> kinds = {};  ///< kinds of case
};

/// The places of these kinds of case (schema_names), in the order of the schemas. Kinds of case in
/// which a place has the same meaning share one entry.
[[nodiscard]] std::vector<KeyPlace> key_places(const std::vector<std::string>& kinds);

}  // namespace wheeltap::apps
