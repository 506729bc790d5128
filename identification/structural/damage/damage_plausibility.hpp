// Plausibility checks of a damage case before sampling, for example lengths in millimetres or noise
// in per cent.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/structural/damage/damage_problem.hpp"

namespace wheeltap::identification {

/// Returns the remarks of structure_plausibility.hpp. Also reports the data if at least half of the
/// frequencies differ by more than a tenth and by more than 5 sd from all predictions of 200 prior
/// draws. Also reports the stated noise if, for every frequency, it exceeds twice the range of the
/// 200 predictions.
[[nodiscard]] std::vector<Remark> implausible(const DamageProblem& problem);

}  // namespace wheeltap::identification
