// Mutually exclusive locations of damage that the data do not distinguish.
#pragma once

#include <optional>
#include <vector>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/damage/findings/unpacked_draws.hpp"

namespace wheeltap::identification {

/// Probability of a defect at each location, and of defects at both locations of each pair.
struct PlaceProbabilities {
  std::vector<double> each;               ///< n
  std::vector<std::vector<double>> both;  ///< symmetric n × n matrix; the diagonal is not used
};

/// Finds groups of locations that exclude each other. In a group, each location is damaged with a
/// probability of at least 5 %. The probability that both locations of a pair are damaged is at
/// most a tenth of the smaller of the two single probabilities. The total probability of a group is
/// at least one half. Groups and locations are sorted, most probable first; a location is in at
/// most one group.
[[nodiscard]] std::vector<std::vector<int>> exclusive_groups(const PlaceProbabilities& places);

/// Adds one remark per group of members, joints or storeys, over all kinds. Omits groups whose
/// locations are only images of each other in `symmetry`.
void add_rival_remarks(const UnpackedDraws& draws, const std::optional<SymmetryFinding>& symmetry,
                       std::vector<Remark>& remarks);

}  // namespace wheeltap::identification
