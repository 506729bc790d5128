// Where a case states its states of the structure.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Those of /baseline/data and /data that are objects.
[[nodiscard]] std::vector<Pointer> state_blocks(const CaseFile& file);

/// The places of the states in a block; without states, the place of the block itself.
[[nodiscard]] std::vector<Pointer> state_places(const CaseFile& file, const Pointer& block);

/// The places of the values that the states give to the coefficient `name` ("known").
[[nodiscard]] std::vector<Pointer> known_places(const CaseFile& file, const std::string& name);

}  // namespace wheeltap::apps
