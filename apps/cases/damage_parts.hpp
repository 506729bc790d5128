// Parsing functions that damage cases of beams and of structures share.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::apps {

/// Parses the prior of a quantity in [lower, upper]; `allowed` states the bounds for the error
/// message. Throws Failure.
[[nodiscard]] inference::Prior bounded_prior(const CaseFile& file, const Pointer& where,
                                             double lower, double upper,
                                             const std::string& allowed);

/// Parses the prior weights of the damage counts min, …, max at `where` ("count"). Normalises the
/// weights to a sum of 1. Throws Failure.
[[nodiscard]] std::vector<double> parse_count_prior(const CaseFile& file, const Pointer& where,
                                                    int min, int max);

/// Parses the simulation settings in "truth" and "data"; does not parse the defects.
[[nodiscard]] identification::Simulation parse_simulation(const CaseFile& file, const Json& truth,
                                                          identification::Simulation before);

/// Parses "extent", the length of a stiffness reduction: absent, a number, or a prior on lengths up
/// to `most` [m]. Throws Failure.
void parse_extent(const CaseFile& file, const Pointer& where, double most,
                  identification::DefectKind& kind);
/// Parses the true extent of the defect at `where`; 0 if its kind has no unknown extent. Throws
/// Failure.
[[nodiscard]] double true_extent(const CaseFile& file, const Pointer& where,
                                 const identification::DefectKind& kind);

/// Returns the relation between crack depth and spring stiffness that the case gives for the crack
/// at `where`, or the default relation. Throws Failure for an unknown name.
[[nodiscard]] const fem::CrackLaw* parse_crack_law(const CaseFile& file, const Pointer& where);

/// Parses the kinds of defect of a structure, with their possible sites. Throws Failure.
void parse_structure_kinds(const CaseFile& file, identification::DamageCase& out,
                           std::vector<Pointer>& kinds);

/// Checks that the structure has as many modes as the case needs. Throws Failure.
void check_structure_modes(const CaseFile& file, identification::DamageCase& out);

}  // namespace wheeltap::apps
