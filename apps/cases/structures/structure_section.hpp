// The cross-section of a structure's member: its stiffnesses in the plane or in space.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/cases/structures/structure_parameters.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::apps {

/// The material of a piece of a member, as the case has it.
struct MaterialCoefficients {
  Coefficient young, poisson, density;
};

/// A section of one material.
struct PieceSection {
  /// At these values of the parameters. Throws std::invalid_argument for sizes that do not fit
  /// into each other.
  std::function<fem::MemberSection(std::span<const double>)> at;
  bool depends = false;                   ///< on a parameter
  double density_factor = 1.0;            ///< of several materials: mass per length over ρ A
  std::vector<std::string> remarks = {};  ///< what is left out, in words
};

/// The section at `where`: a shape with sizes, an outline, or its stiffnesses. Of the shapes,
/// bending is exact, shear is Cowper's; torsion is exact for rectangles, circles and tubes. All
/// else is meshed, once: its sizes must be numbers. Throws Failure.
[[nodiscard]] PieceSection parse_piece_section(const CaseFile& file, const Pointer& where,
                                               const MaterialCoefficients& material, int dimension,
                                               StructureParameters& parameters);

}  // namespace wheeltap::apps
