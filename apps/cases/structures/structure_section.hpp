// Cross-section of a member of a plane or three-dimensional structure: stiffnesses and area.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/cases/structures/structure_parameters.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::apps {

/// Material of a segment of a member, as given in the case.
struct MaterialCoefficients {
  Coefficient young, poisson, density;
};

/// A section of one material.
struct PieceSection {
  /// Computes the section for given values of the parameters. Throws std::invalid_argument for
  /// inconsistent dimensions.
  std::function<fem::MemberSection(std::span<const double>)> at;
  bool depends = false;                   ///< true if the section depends on a parameter
  double density_factor = 1.0;            ///< mass per length, divided by ρ A; 1 for one material
  std::vector<std::string> remarks = {};  ///< messages about neglected properties
};

/// Parses the section at `where`: a shape with dimensions, an outline, or stiffnesses. For shapes,
/// bending stiffnesses are exact and shear stiffnesses use Cowper's coefficients. Torsional
/// stiffnesses are exact for rectangles, circles and tubes. Other properties are computed once, on
/// a mesh; for these, the dimensions must be numbers, not parameters. Throws Failure.
[[nodiscard]] PieceSection parse_piece_section(const CaseFile& file, const Pointer& where,
                                               const MaterialCoefficients& material, int dimension,
                                               StructureParameters& parameters);

}  // namespace wheeltap::apps
