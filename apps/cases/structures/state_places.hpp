// Locations of the states of the structure in a case.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// Returns /baseline/data and /data; omits a location whose value is not an object.
[[nodiscard]] std::vector<Pointer> state_blocks(const CaseFile& file);

/// The locations of the states in a block of data; without states, the location of the block.
[[nodiscard]] std::vector<Pointer> state_places(const CaseFile& file, const Pointer& block);

/// The locations of the values that the states assign to the coefficient `name` (key "known").
[[nodiscard]] std::vector<Pointer> known_places(const CaseFile& file, const std::string& name);

}  // namespace wheeltap::apps
