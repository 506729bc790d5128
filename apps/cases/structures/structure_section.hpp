// Cross-section of a structure's member: stiffnesses in the plane or in space.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/cases/structures/structure_parameters.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::apps {

/// Material of a piece of a member, as in the case.
struct MaterialCoefficients {
  Coefficient young, poisson, density;
};

/// A section of one material.
struct PieceSection {
  /// The section at these values of the parameters. Throws std::invalid_argument for inconsistent
  /// sizes.
  std::function<fem::MemberSection(std::span<const double>)> at;
  bool depends = false;                   ///< on a parameter
  double density_factor = 1.0;            ///< for several materials: mass per length over ρ A
  std::vector<std::string> remarks = {};  ///< neglected properties, in words
};

/// Parses the section at `where`: a shape with sizes, an outline, or stiffnesses. For shapes,
/// bending is exact and shear is Cowper's; torsion is exact for rectangles, circles and tubes.
/// Other properties are computed on one mesh, so the sizes must be numbers. Throws Failure.
[[nodiscard]] PieceSection parse_piece_section(const CaseFile& file, const Pointer& where,
                                               const MaterialCoefficients& material, int dimension,
                                               StructureParameters& parameters);

}  // namespace wheeltap::apps
