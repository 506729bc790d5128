// Plausibility checks of a case before sampling, based on the RMS of its responses.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Reports three faults. The RMS of a response is more than 30 times, or less than a 30th of, the
/// RMS of every prior draw in every model. The stated noise is above the RMS of its response. The
/// prior of a parameter excludes the true value of a simulated record. For a long record, the
/// function uses the first 2000 scored samples.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
