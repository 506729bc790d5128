// Plausibility checks of a damage case before sampling, for example lengths in millimetres or noise
// in per cent.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/structural/damage/damage_problem.hpp"

namespace wheeltap::identification {

/// Adds the remarks of structure_plausibility.hpp. Also reports frequencies that differ from those
/// predicted by 200 prior draws by more than a tenth and 5 sd in at least half of the modes. Also
/// reports a stated noise that is more than twice the largest change of every frequency by the
/// damages of these draws.
[[nodiscard]] std::vector<Remark> implausible(const DamageProblem& problem);

}  // namespace wheeltap::identification
