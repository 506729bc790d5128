// A structure that is another program's matrices.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// M and the K_j of K = Σ (1 + α_j) K_j, from the files that /structure names. A substructure of
/// several matrices is their sum. Throws Failure, io::FileError.
[[nodiscard]] identification::StructureModel parse_matrices(const CaseFile& file);

}  // namespace wheeltap::apps
