// Plausibility checks of a case before sampling, based on the RMS of its responses.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Reports three faults. First: the RMS of a response is above 30 times, or below a 30th of, the
/// RMS of every prior draw in every model. Second: the stated noise exceeds the RMS of its
/// response. Third: the prior of a parameter excludes the true value of a simulated record. The
/// function uses at most the first 2000 scored samples of a record.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
