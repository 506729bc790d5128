// The structure of a monitor case, what may change in it, and how changes are explained.
#pragma once

#include <optional>
#include <vector>

#include "apps/cases/damage_case.hpp"
#include "identification/monitoring/change_explanation.hpp"

namespace wheeltap::apps {

struct MonitoredStructure {
  /// The kinds of defect are those of the case. Unless one of them is an added mass, an added mass
  /// anywhere follows them, where the structure has members or is a chain.
  DamageCaseFile parsed;
  std::vector<int> modes = {};         ///< elastic mode (from 0) of each feature
  std::vector<double> intact_hz = {};  ///< their frequencies in the model
  /// Weights, kinds and their shares; the sds depend on learning.
  identification::monitoring::CauseOptions causes = {};
};

/// Whether the case has a structure or a beam.
[[nodiscard]] bool has_monitored_structure(const CaseFile& file);

/// Parses "structure" or "beam", "damage" and "explanation" of a validated case with `features`
/// features; empty if it has none of them. Throws Failure (65).
[[nodiscard]] std::optional<MonitoredStructure> parse_monitored_structure(const CaseFile& file,
                                                                          std::size_t features);

}  // namespace wheeltap::apps
