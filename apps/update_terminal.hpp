// What an update found, for a terminal.
#pragma once

#include <iosfwd>

#include "apps/update_case.hpp"
#include "identification/update_findings.hpp"

namespace wheeltap::apps {

void print_update(std::ostream& out, const UpdateCaseFile& parsed,
                  const identification::UpdateFindings& findings, bool colour);

}  // namespace wheeltap::apps
