// Terminal text of a model-updating run.
#pragma once

#include <iosfwd>

#include "apps/cases/update_case.hpp"
#include "identification/structural/updating/update_findings.hpp"

namespace wheeltap::apps {

void print_update(std::ostream& out, const UpdateCaseFile& parsed,
                  const identification::UpdateFindings& findings, bool colour);

}  // namespace wheeltap::apps
