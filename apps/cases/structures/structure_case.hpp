// The structure of a case: its members, a chain, or another program's matrices.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "fem/structures/structure.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Most degrees of freedom that are built: the modes of so many take a minute or two.
inline constexpr long long kMostDegreesOfFreedom = 300'000;

/// Whether the case has a structure. Throws Failure for a case with a beam as well.
[[nodiscard]] bool has_structure(const CaseFile& file);

/// The structure with its parameters, of a case that has been held against the schema "structure".
/// What the members leave out of their sections is added to `remarks`, in words. Throws Failure
/// (65) for what is wrong in it, with its place; for more degrees of freedom than are built, with
/// their cost; as io::read_sparse_matrix does for files.
[[nodiscard]] identification::StructureModel parse_structure(
    const CaseFile& file, std::vector<std::string>* remarks = nullptr);

/// What fem finds wrong with a structure, as a complaint about the case. Throws Failure (65).
[[noreturn]] void refuse_structure(const CaseFile& file,
                                   const identification::AnyStructure& structure,
                                   const fem::InvalidStructure& error);

}  // namespace wheeltap::apps
