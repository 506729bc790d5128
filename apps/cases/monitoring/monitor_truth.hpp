// The truth of a monitor case, for `wheeltap simulate`: features over years, with effects of the
// weather and changes of the structure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

/// A simulated table.
struct SimulatedTable {
  std::string csv = {};  ///< CSV text, with the columns that the case names
  int rows = 0, features = 0;
  std::uint64_t seed = 1;
};

/// Simulates the table of a monitor case with "truth"; the file of the table need not exist. If
/// `seed` is empty, the function uses the key "seed" of "truth" (default 1). Throws Failure (65).
[[nodiscard]] SimulatedTable simulated_table(CaseFile file, std::optional<std::uint64_t> seed);

}  // namespace wheeltap::apps
