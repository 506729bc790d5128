// `wheeltap modes` of a structure.
#pragma once

#include "apps/case_file.hpp"
#include "apps/commands.hpp"

namespace wheeltap::apps {

/// Natural frequencies and shapes with every parameter at its nominal value: a table, JSON, and a
/// VTK file. Throws Failure; 65 for mechanisms and axial forces beyond buckling.
void run_structure_modes(CaseFile file, const ModesOptions& options);

}  // namespace wheeltap::apps
