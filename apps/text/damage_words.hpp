// Sentences on the length that damages cover, and on adjacent damages.
#pragma once

#include <string>

#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// A length as text: "8 mm", "0.25 m".
[[nodiscard]] std::string length_in_words(double metres);

/// Returns "over 8 mm (one element)", "over 30 mm" or, for an inferred extent, "over 31 mm (18 to
/// 45 mm)"; empty for defects without a length. `location` [m] is measured along the line of
/// possible sites of the kind.
[[nodiscard]] std::string extent_in_words(const identification::DefectKind& kind, double location,
                                          const identification::Marginal* extent);

/// Returns "1 damage 98 % and 2 damages 2 %": the probabilities of the counts, with adjacent
/// damages counted as one damage.
[[nodiscard]] std::string merged_counts_in_words(const identification::DefectKind& kind,
                                                 const identification::MergedFinding& merged);

/// Returns "These two are adjacent: one longer damage, 31 mm (18 to 45 mm) long about 0.221 m …
/// explains the data equally well …". `damages` is the number of damages in the model.
[[nodiscard]] std::string longer_in_words(const identification::DefectKind& kind, int damages,
                                          const identification::MergedModel& merged);

}  // namespace wheeltap::apps
