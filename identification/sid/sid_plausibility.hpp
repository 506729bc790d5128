// Plausibility checks of a case before sampling, by the size of its responses.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Reports responses whose RMS is 30 times, or a 30th of, that of any prior draw in any model,
/// stated noise above the RMS of its response, and true parameters of a simulated record that their
/// priors exclude. Uses the first 2000 scored samples of a long record.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
