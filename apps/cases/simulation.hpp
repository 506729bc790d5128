// What a case's truth would measure, before it is written anywhere.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

struct DamageCaseFile;

/// A damage or update case with modes simulated from its truth in place of its data.
struct SimulatedCase {
  Json json;
  int modes = 0;
  std::string origin;  ///< of the numbers, in words
};
/// `seed` is of the noise; none: the truth's own, or 1. Throw Failure.
[[nodiscard]] SimulatedCase simulated_update(CaseFile file, std::optional<std::uint64_t> seed);
[[nodiscard]] SimulatedCase simulated_damage(CaseFile file, std::optional<std::uint64_t> seed);
/// The case with these frequencies, and shapes where it has sensors. Throws Failure.
[[nodiscard]] Json with_simulated(const DamageCaseFile& parsed,
                                  const identification::FrequencyData& data, std::uint64_t seed);

/// The record that a sid case's truth produces.
struct SimulatedRecord {
  signals::Record record;
  std::string title;
  std::uint64_t seed = 1;
};
/// `seed` as above. Throws Failure.
[[nodiscard]] SimulatedRecord simulated_record(CaseFile file, std::optional<std::uint64_t> seed);

}  // namespace wheeltap::apps
