// `wheeltap modes` of a structure.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "apps/runs/found_modes.hpp"

namespace wheeltap::apps {

/// Computes natural frequencies and shapes with every parameter at its nominal value, and writes
/// the VTK file of the options. Throws Failure, for example 65 for mechanisms and for axial forces
/// above the buckling load.
[[nodiscard]] FoundModes find_structure_modes(CaseFile file, const ModesOptions& options);

}  // namespace wheeltap::apps
