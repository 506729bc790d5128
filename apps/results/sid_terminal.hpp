// Terminal text of a system-identification run.
#pragma once

#include <iosfwd>

#include "apps/cases/sid_case.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Prints the results of a finished run. `sid_case` is the case of the problem, with the residual
/// models that were chosen.
void print_sid(std::ostream& out, const identification::SidCase& sid_case,
               const identification::SidFindings& findings, bool colour);

}  // namespace wheeltap::apps
