// Cross-sections that are given by their dimensions, and formulas for their properties.
//
// To add a shape, add a line to the list in section_shapes.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fem/sections/outline.hpp"
#include "fem/sections/section.hpp"

namespace wheeltap::fem {

/// A cross-section with formulas for its properties. All functions take the dimensions [m] in the
/// order of `sizes`. The functions for the shear coefficient and the torsion constant are null for
/// shapes without a formula; Wheeltap then computes these properties on a mesh of the outline.
struct SectionShape {
  std::string name;                ///< "rectangle"
  std::vector<std::string> sizes;  ///< names of the dimensions: "width", "height"
  /// Computes A, I_y = ∫z² dA and Cowper's κ_z. Throws std::invalid_argument in the same cases as
  /// section().
  Section (*plane)(std::span<const double> sizes, double poisson);
  double (*second_moment_z)(std::span<const double> sizes);  ///< ∫y² [m⁴]
  double (*shear_coefficient_y)(std::span<const double> sizes, double poisson);
  double (*torsion_constant)(std::span<const double> sizes);  ///< Saint-Venant's J [m⁴]
  double (*depth)(std::span<const double> sizes);             ///< outer dimension along z [m]
  /// Computes the outline, with y along the width and the origin at the centre. Circles become
  /// polygons of equal area.
  Region (*outline)(std::span<const double> sizes);
};

[[nodiscard]] const std::vector<SectionShape>& section_shapes();

/// Returns the shape with this name, or null for an unknown name.
[[nodiscard]] const SectionShape* find_section_shape(std::string_view name);

}  // namespace wheeltap::fem
