// Data simulated from a case's truth, not yet written.
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
  std::string origin;  ///< origin of the numbers, in words
};
/// `seed` is the seed of the noise; if it is empty, the seed of the truth or else 1 is used. Both
/// functions throw Failure.
[[nodiscard]] SimulatedCase simulated_update(CaseFile file, std::optional<std::uint64_t> seed);
[[nodiscard]] SimulatedCase simulated_damage(CaseFile file, std::optional<std::uint64_t> seed);
/// The case with these frequencies, and shapes if it has sensors. Throws Failure.
[[nodiscard]] Json with_simulated(const DamageCaseFile& parsed,
                                  const identification::FrequencyData& data, std::uint64_t seed);

/// The record simulated from the truth of a sid case.
struct SimulatedRecord {
  signals::Record record;
  std::string title;
  std::uint64_t seed = 1;
};
/// `seed` is the seed of the noise, as for simulated modes. Throws Failure.
[[nodiscard]] SimulatedRecord simulated_record(CaseFile file, std::optional<std::uint64_t> seed);

}  // namespace wheeltap::apps
