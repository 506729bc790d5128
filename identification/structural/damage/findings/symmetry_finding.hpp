// Effect of a structure's symmetry on the posterior.
#pragma once

#include <vector>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/damage/findings/unpacked_draws.hpp"

namespace wheeltap::identification {

/// Estimates for a symmetric beam, one table per model: locations are measured from the nearer end,
/// and components are sorted by this distance. Unfolded estimates would average over mirror images.
[[nodiscard]] std::vector<std::vector<ParameterFinding>> folded(const UnpackedDraws& draws);

/// The number of defects that precede their mirror images along the line, minus the number of
/// defects that follow their mirror images, for each draw. The mean of this difference is near zero
/// if the chains mix between images.
[[nodiscard]] inference::ChainsOf left_less_right(const UnpackedDraws& draws);

/// Summarises `difference`, the result of `left_less_right`. Adds remarks if necessary.
[[nodiscard]] SymmetryFinding symmetry(const UnpackedDraws& draws,
                                       const inference::ChainsOf& difference,
                                       std::vector<Remark>& remarks);

}  // namespace wheeltap::identification
