// Parts that damage cases of beams and of structures share.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::apps {

/// A prior of something that must lie in [lower, upper]; `allowed` says so in words. Throws
/// Failure.
[[nodiscard]] inference::Prior bounded_prior(const CaseFile& file, const Pointer& where,
                                             double lower, double upper,
                                             const std::string& allowed);

/// Weights of the counts min … max that stand at `where` ("count"), of sum 1. Throws Failure.
[[nodiscard]] std::vector<double> parse_count_prior(const CaseFile& file, const Pointer& where,
                                                    int min, int max);

/// What "truth" and "data" say of a simulation, beside its defects.
[[nodiscard]] identification::Simulation parse_simulation(const CaseFile& file, const Json& truth,
                                                          identification::Simulation before);

/// What "extent" says of a reduction: nothing, a length, or a prior of one up to `most` [m]. Throws
/// Failure.
void parse_extent(const CaseFile& file, const Pointer& where, double most,
                  identification::DefectKind& kind);
/// The extent of a true defect at `where`, where it is unknown. Throws Failure.
[[nodiscard]] double true_extent(const CaseFile& file, const Pointer& where,
                                 const identification::DefectKind& kind);

/// The law that a crack names, or the first. Throws Failure for one that there is not.
[[nodiscard]] const fem::CrackLaw* parse_crack_law(const CaseFile& file, const Pointer& where);

/// The kinds of defect of a structure, with where they may be. Throws Failure.
void parse_structure_kinds(const CaseFile& file, identification::DamageCase& out,
                           std::vector<Pointer>& kinds);

/// That the structure has the modes that the case asks for. Throws Failure.
void check_structure_modes(const CaseFile& file, identification::DamageCase& out);

}  // namespace wheeltap::apps
