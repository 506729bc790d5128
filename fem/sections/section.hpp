// Section properties and shear coefficients of the common cross-sections.
#pragma once

#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// Cowper's shear coefficients κ(ν) (Cowper 1966, J. Appl. Mech. 33:335, table 1).
[[nodiscard]] double cowper_rectangle(double poisson);  ///< 10 (1 + ν) / (12 + 11 ν)
[[nodiscard]] double cowper_circle(double poisson);     ///< 6 (1 + ν) / (7 + 6 ν)
/// Cowper's shear coefficient of a tube with m = inner / outer radius: 6 (1 + ν)(1 + m²)² / ((7 + 6
/// ν)(1 + m²)² + (20 + 12 ν) m²).
[[nodiscard]] double cowper_tube(double poisson, double radius_ratio);

/// Computes Saint-Venant's torsion constant of a rectangle with the sides a and b [m⁴] (Timoshenko
/// & Goodier, Theory of Elasticity, 3rd ed., section 109). For a >= b,
///
///   J = a b³ (1/3 - 64/π⁵ b/a Σ_{n odd} tanh(nπa/2b) / n⁵)
[[nodiscard]] double rectangle_torsion_constant(double a, double b);

struct Rectangle {
  double width, height;
};  ///< [m]; the bending axis is parallel to the width
struct Circle {
  double diameter;
};  ///< [m]
struct Tube {
  double outer_diameter, thickness;
};  ///< [m]
struct ISection {
  double height, width, flange_thickness, web_thickness;
};  ///< [m]
struct Box {
  double height, width, flange_thickness, web_thickness;
};  ///< outer dimensions [m]

/// Computes area A, second moment I and Cowper's shear coefficient κ of the shape. Throws
/// std::invalid_argument for dimensions that are not positive, or for inner dimensions that do not
/// fit into the outer dimensions.
[[nodiscard]] Section section(const Rectangle& shape, double poisson);
[[nodiscard]] Section section(const Circle& shape, double poisson);
[[nodiscard]] Section section(const Tube& shape, double poisson);
[[nodiscard]] Section section(const ISection& shape, double poisson);
[[nodiscard]] Section section(const Box& shape, double poisson);

}  // namespace wheeltap::fem
