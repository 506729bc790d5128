// What a case says that can hardly be meant, seen before anything is sampled: lengths in
// millimetres, noise in per cent, channels of another size than any model's.
#pragma once

#include <vector>

#include "identification/damage_problem.hpp"
#include "identification/remarks.hpp"
#include "identification/sid_problem.hpp"
#include "identification/update_case.hpp"

namespace wheeltap::identification {

/// What structure_plausibility.hpp finds; frequencies that are farther from what 200 draws of the
/// prior predict than a tenth of themselves and 5 sd, in at least half of the modes; a stated noise
/// of which the damages of these draws move no frequency by half.
[[nodiscard]] std::vector<Remark> implausible(const DamageProblem& problem);

/// Of the structure and its sensors (structure_plausibility.hpp).
[[nodiscard]] std::vector<Remark> implausible(const UpdateCase& update_case);

/// Responses whose root mean square is 30 times, or a 30th of, what any of the prior's draws
/// predicts in any model; a stated noise above the root mean square of its response. Of a
/// long record the first 2000 scored samples tell. Of a simulated record, true parameters that
/// their priors exclude.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
