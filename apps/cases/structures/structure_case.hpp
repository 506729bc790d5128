// Structure of a case: members, a chain, or matrices of another program.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "fem/structures/structure.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Largest number of degrees of freedom. At this size, the computation of the modes takes one or
/// two minutes.
inline constexpr long long kMostDegreesOfFreedom = 300'000;

/// True if the case has a structure. Throws Failure for a case with both a structure and a beam.
[[nodiscard]] bool has_structure(const CaseFile& file);

/// Parses the structure and its parameters in a case that satisfies the schema "structure". Appends
/// to `remarks` one sentence for each section property that the member model neglects. Throws
/// Failure (65) for invalid values, with their location in the case. Throws Failure (65) for too
/// many degrees of freedom, with the required memory. Also throws the exceptions of
/// io::read_sparse_matrix.
[[nodiscard]] identification::StructureModel parse_structure(
    const CaseFile& file, std::vector<std::string>* remarks = nullptr);

/// Throws Failure (65) with the message of an FE library error and its location in the case.
[[noreturn]] void refuse_structure(const CaseFile& file,
                                   const identification::AnyStructure& structure,
                                   const fem::InvalidStructure& error);

}  // namespace wheeltap::apps
