// The truth of a monitor case: years under weather, with changes, for `wheeltap simulate`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// A simulated table.
struct SimulatedTable {
  std::string csv = {};  ///< columns as the case names them
  int rows = 0, features = 0;
  std::uint64_t seed = 1;
};

/// The table of a monitor case with "truth"; its file need not exist. `seed`: empty for the
/// truth's, or 1. Throws Failure (65).
[[nodiscard]] SimulatedTable simulated_table(CaseFile file, std::optional<std::uint64_t> seed);

}  // namespace wheeltap::apps
