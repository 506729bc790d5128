// The structure of a monitor case, its possible changes, and the explanation of changes.
#pragma once

#include <optional>
#include <vector>

#include "apps/cases/damage_case.hpp"
#include "identification/monitoring/causes/change_explanation.hpp"

namespace wheeltap::apps {

struct MonitoredStructure {
  /// The kinds of defect of the case. If the case has no kind of added mass, and the structure has
  /// members or is a chain of masses, the kind "added mass at any location" is appended.
  DamageCaseFile parsed;
  std::vector<int> modes = {};         ///< index (from 0) of the elastic mode of each feature
  std::vector<double> intact_hz = {};  ///< frequencies of these modes in the intact model
  /// Prior weights of the causes and of the kinds of defect. The training sets the
  /// standard deviations in `causes`.
  identification::monitoring::CauseOptions causes = {};
};

/// True if the case has a structure or a beam.
[[nodiscard]] bool has_monitored_structure(const CaseFile& file);

/// Parses "structure" or "beam", "damage" and "explanation" of a validated case with `features`
/// features; empty if the case has none of these keys. Throws Failure (65).
[[nodiscard]] std::optional<MonitoredStructure> parse_monitored_structure(const CaseFile& file,
                                                                          std::size_t features);

}  // namespace wheeltap::apps
