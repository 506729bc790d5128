// Computation of section properties: a finite-element solution of Saint-Venant's torsion and
// flexure problems of a cross-section.
//
// Let y and z be coordinates from the centroid, e = E/E_ref, g = G/G_ref, and c_j = M⁻¹ (unit
// vector j) for M = [∫e y² ∫e yz; ∫e yz ∫e z²]. The warping function ω and the flexure functions
// ψ_y, ψ_z satisfy, for all functions v,
//
//   ∫ g ∇ω·∇v   = ∫ g (z ∂v/∂y - y ∂v/∂z)                                        (twist)
//   ∫ g ∇ψ_j·∇v = ∫ g ν/2 d_j·∇v + 2 (1 + ν_ref) ∫ e c_j·(y, z) v                (shear force j)
//   d = (c_y (y² - z²) + 2 c_z yz,  2 c_y yz - c_z (y² - z²))
//
// A unit rate of twist causes the stresses τ = G_ref g (∇ω + (-z, y)). A unit force along j causes
// the stresses τ_j = g (∇ψ_j - ν/2 d_j) / (2 (1 + ν_ref)). The section properties follow from these
// stresses:
//
//   J    = ∫ g |∇ω + (-z, y)|²
//   α_ij = 1/κ_ij = ∫G ∫ τ_i·τ_j / G   (equal strain energy)
//   y_s  = ∫ (y τ_zz - z τ_zy), z_s likewise: a force along this line causes no twist
//   Γ    = ∫ e ω_D²,  ω_D = ω - z_D y + y_D z + a, with D (Trefftz's centre) and a such that ω_D
//          does no work with extension or bending
//
// These formulas follow Pilkey (2002), Analysis and Design of Elastic Beams, chapters 5 to 7, who
// assumes one Poisson's ratio. If the regions have different Poisson's ratios, the in-plane strains
// that compatibility requires are neglected.
#pragma once

#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "fem/sections/outline.hpp"
#include "fem/sections/triangle_mesh.hpp"

namespace wheeltap::fem {

/// Second moments of area about axes through the centroid [m⁴].
struct SecondMoments {
  double yy;  ///< ∫ e z²: bending about y, deflection along z
  double zz;  ///< ∫ e y²
  double yz;  ///< ∫ e y z
};

struct PrincipalAxes {
  double largest, smallest;  ///< second moments [m⁴]
  double angle;  ///< angle from y to the axis with the largest moment, in (-π/2, π/2]; 0 for equal
                 ///< moments
};
[[nodiscard]] PrincipalAxes principal_axes(const SecondMoments& moments);

/// Shear flexibility coefficients α = 1/κ. A shear force V has the strain energy ½ Vᵀ α V / (G A)
/// per unit length.
struct ShearFlexibility {
  double yy, zz, yz;
};

/// Section properties, weighted with the moduli relative to E_ref and G_ref = E_ref / (2 (1 +
/// ν_ref)). The axial stiffness is E_ref · area, the torsional stiffness G_ref · torsion_constant.
/// For a single material with modulus 1, all properties are the usual geometric ones.
struct SectionProperties {
  double area;               ///< ∫ e [m²]
  double geometric_area;     ///< ∫ 1 [m²]
  double shear_area;         ///< ∫ g [m²]: the shear stiffness is G_ref · shear_area / α
  double mass_per_length;    ///< ∫ ρ [kg/m]
  Eigen::Vector2d centroid;  ///< weighted by e, in the outline's axes [m]
  SecondMoments second_moments;
  double torsion_constant;             ///< J [m⁴]
  double warping_constant;             ///< Γ [m⁶]
  Eigen::Vector2d shear_centre;        ///< position from the centroid [m]; depends on ν
  Eigen::Vector2d trefftz_centre;      ///< position from the centroid [m]; independent of ν
  ShearFlexibility shear_flexibility;  ///< α from the strain energy
};

/// Section properties computed on one mesh.
struct SectionLevel {
  int triangles, nodes;
  SectionProperties properties;
};

/// Relative change of each property at the last mesh refinement. For a property near zero, the
/// change is divided by a reference value: by 1e-4 (I_yy + I_zz)²/A for Γ, by a tenth of the
/// radius of gyration for a centre, and by a twentieth of √(α_yy α_zz) for α_yz. The remaining
/// error is the change divided by 2^p - 1, where p is the order of convergence (4 for smooth
/// solutions).
struct SectionErrors {
  double torsion_constant, warping_constant, shear_centre, shear_flexibility;
  [[nodiscard]] double largest() const;
};

struct SectionAnalysis {
  SectionProperties properties;  ///< properties on the finest mesh
  SectionErrors errors;
  std::vector<SectionLevel> levels;  ///< one entry per mesh, from the coarsest mesh to the finest
  bool converged;  ///< all properties are finite, and errors.largest() <= tolerance
  [[nodiscard]] bool finite() const;  ///< true if all properties of the finest mesh are finite
};

struct SectionAnalysisOptions {
  double reference_poisson = 0.3;  ///< ν_ref, which defines G_ref
  double tolerance = 2e-4;         ///< largest relative change at the last refinement, > 0
  int most_nodes = 600'000;        ///< largest number of nodes of a mesh
  int least_levels = 2;            ///< smallest number of meshes, >= 2
};

/// Computes the section properties on one mesh with quadratic triangles and one Cholesky
/// factorisation by CHOLMOD. The functions ω and ψ are unique up to a constant, so the value at one
/// node is set to zero. The indices in mesh.regions refer to `regions`. Throws
/// std::invalid_argument for too few regions or a mesh without area.
[[nodiscard]] SectionProperties section_properties(const TriangleMesh& mesh,
                                                   std::span<const Region> regions,
                                                   double reference_poisson);

/// Computes the section properties on a sequence of refined meshes, graded towards the corners,
/// until the properties converge. The refinement stops earlier if a property is not finite, or if
/// the changes show that the tolerance cannot be reached. Throws the exceptions of
/// section_properties, and std::invalid_argument for options out of range.
[[nodiscard]] SectionAnalysis analyse_section(TriangleMesh mesh, std::span<const Region> regions,
                                              const SectionAnalysisOptions& options = {});

}  // namespace wheeltap::fem
