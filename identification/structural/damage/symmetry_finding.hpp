// What a structure's symmetry makes of a posterior.
#pragma once

#include <vector>

#include "identification/structural/damage/damage_findings.hpp"
#include "identification/structural/damage/unpacked_draws.hpp"

namespace wheeltap::identification {

/// Locations counted from the nearer end, and the components ordered by that: for a symmetric beam
/// the plain summaries average over mirror images. One table a model.
[[nodiscard]] std::vector<std::vector<ParameterFinding>> folded(const UnpackedDraws& draws);

/// Expected number of defects before their images less that beyond, draw by draw: a quantity that
/// mirrors must balance.
[[nodiscard]] inference::ChainsOf left_less_right(const UnpackedDraws& draws);

/// `difference` as `left_less_right` has it; adds a remark where there is something to tell.
[[nodiscard]] SymmetryFinding symmetry(const UnpackedDraws& draws,
                                       const inference::ChainsOf& difference,
                                       std::vector<Remark>& remarks);

}  // namespace wheeltap::identification
