// Places of which one is damaged, and the data do not say which.
#pragma once

#include <optional>
#include <vector>

#include "identification/structural/damage/damage_findings.hpp"
#include "identification/structural/damage/unpacked_draws.hpp"

namespace wheeltap::identification {

/// How often each place holds a defect, and each two of them at once.
struct PlaceProbabilities {
  std::vector<double> each;               ///< n
  std::vector<std::vector<double>> both;  ///< n × n, symmetric; its diagonal is not read
};

/// Groups of places that exclude each other: every one with at least 5 %, any two at once in at
/// most a tenth of what the rarer has, and half or more in all of them together. The likeliest
/// first, in groups and among them; a place is in one group at most.
[[nodiscard]] std::vector<std::vector<int>> exclusive_groups(const PlaceProbabilities& places);

/// One remark a group of members, joints or storeys, of all kinds; none where a structure's own
/// images, as `symmetry` lists them, are all there is to a group.
void tell_rivals(const UnpackedDraws& draws, const std::optional<SymmetryFinding>& symmetry,
                 std::vector<Remark>& remarks);

}  // namespace wheeltap::identification
