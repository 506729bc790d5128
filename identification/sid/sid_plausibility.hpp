// What a case of chains says that can hardly be meant, seen before anything is sampled: channels of
// another size than any model's.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Responses whose root mean square is 30 times, or a 30th of, what any of the prior's draws
/// predicts in any model; a stated noise above the root mean square of its response. Of a
/// long record the first 2000 scored samples tell. Of a simulated record, true parameters that
/// their priors exclude.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
