// Plausibility checks of a damage case before sampling, for example lengths in millimetres or noise
// in per cent.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/structural/damage/damage_problem.hpp"

namespace wheeltap::identification {

/// Adds the remarks of structure_plausibility.hpp. Also reports data in which at least half of the
/// frequencies differ from the predictions of 200 prior draws by more than a tenth and 5 sd. Also
/// reports a stated noise of more than twice the largest change that the damages of these draws
/// cause, for every frequency.
[[nodiscard]] std::vector<Remark> implausible(const DamageProblem& problem);

}  // namespace wheeltap::identification
