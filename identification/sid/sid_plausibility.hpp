// Plausibility checks of a case before sampling, based on the RMS of its responses.
#pragma once

#include <vector>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Reports three faults. First check: the RMS of a response differs by a factor of more than 30
/// from its RMS in every prior draw of every model. Second check: the stated noise exceeds the RMS
/// of its response. Third check: the prior of a parameter excludes the true value of a simulated
/// record. Only the first 2000 samples in the likelihood of a record are used.
[[nodiscard]] std::vector<Remark> implausible(const SidProblem& problem);

}  // namespace wheeltap::identification
