// Terminal text of a system-identification run.
#pragma once

#include <iosfwd>

#include "apps/cases/sid_case.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Prints the results of a finished run.
void print_sid(std::ostream& out, const SidCaseFile& parsed,
               const identification::SidFindings& findings, bool colour);

}  // namespace wheeltap::apps
