// What the schema of a system-identification case takes from the library.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// Adds a key for every law there is to the links of a schema that has links.
template <class AnyJson>
void add_laws(AnyJson& schema) {
  if (!schema.at("definitions").contains("link")) return;
  auto& keys = schema["definitions"]["link"]["properties"];
  for (const dynamics::LawInfo& law : dynamics::law_infos())
    keys[std::string(law.name)] = {{"$ref", "#/definitions/law"}};
}

}  // namespace wheeltap::apps
