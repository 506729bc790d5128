// A structure given by the mass and stiffness matrices of another program.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Reads the matrices M and K = Σ (1 + α_j) K_j from the files that /structure names. If several
/// matrices belong to substructure j, K_j is their sum. Throws Failure, io::FileError.
[[nodiscard]] identification::StructureModel parse_matrices(const CaseFile& file);

}  // namespace wheeltap::apps
