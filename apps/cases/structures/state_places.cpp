#include "apps/cases/structures/state_places.hpp"

namespace wheeltap::apps {

std::vector<Pointer> state_blocks(const CaseFile& file) {
  std::vector<Pointer> out;
  for (const char* const path : {"/baseline/data", "/data"})
    if (const Pointer where(path); file.json.contains(where) && file.json.at(where).is_object())
      out.push_back(where);
  return out;
}

std::vector<Pointer> state_places(const CaseFile& file, const Pointer& block) {
  const Json& json = file.json.at(block);
  if (!json.contains("states")) return {block};
  std::vector<Pointer> out;
  for (std::size_t i = 0; i < json["states"].size(); ++i) out.push_back(block / "states" / i);
  return out;
}

std::vector<Pointer> known_places(const CaseFile& file, const std::string& name) {
  std::vector<Pointer> out;
  for (const Pointer& block : state_blocks(file))
    for (const Pointer& state : state_places(file, block))
      if (const Pointer where = state / "known" / name; file.json.contains(where))
        out.push_back(where);
  return out;
}

}  // namespace wheeltap::apps
