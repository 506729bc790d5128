// Section properties of the common shapes, and their shear coefficients.
#pragma once

#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// Cowper's shear coefficients κ(ν) (Cowper 1966, J. Appl. Mech. 33:335, table 1).
[[nodiscard]] double cowper_rectangle(double poisson);  ///< 10 (1 + ν) / (12 + 11 ν)
[[nodiscard]] double cowper_circle(double poisson);     ///< 6 (1 + ν) / (7 + 6 ν)
/// Tube with m = inner / outer radius:
/// 6 (1 + ν)(1 + m²)² / ((7 + 6 ν)(1 + m²)² + (20 + 12 ν) m²).
[[nodiscard]] double cowper_tube(double poisson, double radius_ratio);

/// Saint-Venant's torsion constant of a rectangle with the sides a and b [m⁴] (Timoshenko &
/// Goodier, Theory of Elasticity, 3rd ed., section 109), for a >= b:
///
///   J = a b³ (1/3 - 64/π⁵ b/a Σ_{n odd} tanh(nπa/2b) / n⁵)
[[nodiscard]] double rectangle_torsion_constant(double a, double b);

struct Rectangle {
  double width, height;
};  ///< bending about the width [m]
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
};  ///< outer sizes [m]

/// A, I and Cowper's κ of the shape. Throws std::invalid_argument for sizes that are not positive
/// or do not fit into each other.
[[nodiscard]] Section section(const Rectangle& shape, double poisson);
[[nodiscard]] Section section(const Circle& shape, double poisson);
[[nodiscard]] Section section(const Tube& shape, double poisson);
[[nodiscard]] Section section(const ISection& shape, double poisson);
[[nodiscard]] Section section(const Box& shape, double poisson);

}  // namespace wheeltap::fem
