// Sentences on the length that damages cover, and on adjacent damages.
#pragma once

#include <string>

#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// "8 mm", "0.25 m".
[[nodiscard]] std::string length_in_words(double metres);

/// Returns "over 8 mm (one element)" or "over 30 mm"; for an inferred extent "over 31 mm (18 to
/// 45 mm)"; empty for defects without a length. `location` is on the kind's line [m].
[[nodiscard]] std::string extent_in_words(const identification::DefectKind& kind, double location,
                                          const identification::Marginal* extent);

/// Returns "1 damage 98 % and 2 damages 2 %": the count with neighbours counted as one.
[[nodiscard]] std::string merged_counts_in_words(const identification::DefectKind& kind,
                                                 const identification::MergedFinding& merged);

/// Returns "These two are adjacent: one longer damage, 31 mm (18 to 45 mm) long about 0.221 m …
/// explains the data equally well …". `damages` is their number in the model.
[[nodiscard]] std::string longer_in_words(const identification::DefectKind& kind, int damages,
                                          const identification::MergedModel& merged);

}  // namespace wheeltap::apps
