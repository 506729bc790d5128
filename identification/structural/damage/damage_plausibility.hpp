// What a case of damage says that can hardly be meant, seen before anything is sampled: lengths in
// millimetres, noise in per cent.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/structural/damage/damage_problem.hpp"

namespace wheeltap::identification {

/// What structure_plausibility.hpp finds; frequencies that are farther from what 200 draws of the
/// prior predict than a tenth of themselves and 5 sd, in at least half of the modes; a stated noise
/// of which the damages of these draws move no frequency by half.
[[nodiscard]] std::vector<Remark> implausible(const DamageProblem& problem);

}  // namespace wheeltap::identification
