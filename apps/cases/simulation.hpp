// Data simulated from the truth of a case, before they are written to files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

struct DamageCaseFile;

/// A damage or update case whose data are modes simulated from its truth.
struct SimulatedCase {
  Json json;
  int modes = 0;
  std::string origin;  ///< description of the origin of the data
};
/// simulated_update simulates the data of an update case; simulated_damage simulates the data of a
/// damage case. `seed` is the seed of the noise. If `seed` is empty, the functions use
/// the key "seed" of "truth" (default 1). Both functions throw Failure.
[[nodiscard]] SimulatedCase simulated_update(CaseFile file, std::optional<std::uint64_t> seed);
[[nodiscard]] SimulatedCase simulated_damage(CaseFile file, std::optional<std::uint64_t> seed);
/// The case with the frequencies of `data` and, if the case has sensors, the mode shapes of `data`.
/// Throws Failure.
[[nodiscard]] Json with_simulated(const DamageCaseFile& parsed,
                                  const identification::FrequencyData& data, std::uint64_t seed);

/// The record simulated from the truth of a sid case.
struct SimulatedRecord {
  signals::Record record;
  std::string title;
  std::uint64_t seed = 1;
};
/// Simulates the record of a sid case. `seed` has the same meaning as for simulated_update. Throws
/// Failure.
[[nodiscard]] SimulatedRecord simulated_record(CaseFile file, std::optional<std::uint64_t> seed);

}  // namespace wheeltap::apps
