// Stiffnesses of a cross-section from triangles over it: Saint-Venant's torsion and flexure.
//
// With y, z from the centroid, e = E/E_ref, g = G/G_ref, and c_j = M⁻¹ (unit vector j) for
// M = [∫e y² ∫e yz; ∫e yz ∫e z²], find ω and the flexure functions ψ_y, ψ_z such that, for all v,
//
//   ∫ g ∇ω·∇v   = ∫ g (z ∂v/∂y - y ∂v/∂z)                                        (twist)
//   ∫ g ∇ψ_j·∇v = ∫ g ν/2 d_j·∇v + 2 (1 + ν_ref) ∫ e c_j·(y, z) v                (shear force j)
//   d = (c_y (y² - z²) + 2 c_z yz,  2 c_y yz - c_z (y² - z²))
//
// A unit rate of twist has the stresses τ = G_ref g (∇ω + (-z, y)), a unit force along j has
// τ_j = g (∇ψ_j - ν/2 d_j) / (2 (1 + ν_ref)). From these
//
//   J    = ∫ g |∇ω + (-z, y)|²              α_ij = 1/κ_ij = ∫G ∫ τ_i·τ_j / G   (equal strain
//   energy) y_s  = ∫ (y τ_zz - z τ_zy), z_s likewise: the line along which a force does not twist
//   Γ    = ∫ e ω_D²,  ω_D = ω - z_D y + y_D z + a, with D (Trefftz's centre) and a such that ω_D
//          does no work with extension or bending
//
// after Pilkey (2002), Analysis and Design of Elastic Beams, chapters 5 to 7. He has one Poisson's
// ratio; where those of the regions differ, the strains across the section that they would need to
// stay together are left out.
#pragma once

#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "fem/sections/outline.hpp"
#include "fem/sections/triangle_mesh.hpp"

namespace wheeltap::fem {

/// About axes through the centroid [m⁴].
struct SecondMoments {
  double yy;  ///< ∫ e z²: bending about y, deflection along z
  double zz;  ///< ∫ e y²
  double yz;  ///< ∫ e y z
};

struct PrincipalAxes {
  double largest, smallest;  ///< second moments [m⁴]
  double angle;  ///< of the axis about which it is largest, from y, in (-π/2, π/2]; 0 where equal
};
[[nodiscard]] PrincipalAxes principal_axes(const SecondMoments& moments);

/// α = 1/κ: a shear force V has the energy ½ Vᵀ α V / (G A) a length.
struct ShearFlexibility {
  double yy, zz, yz;
};

/// All moduli relative to E_ref, and G_ref = E_ref / (2 (1 + ν_ref)): E_ref · area is the axial
/// stiffness, G_ref · torsion_constant that in torsion. Of one material with modulus 1: as usual.
struct SectionProperties {
  double area;               ///< ∫ e [m²]
  double geometric_area;     ///< ∫ 1 [m²]
  double shear_area;         ///< ∫ g [m²]: the shear stiffness is G_ref · shear_area / α
  double mass_per_length;    ///< ∫ ρ [kg/m]
  Eigen::Vector2d centroid;  ///< of e, in the outline's axes [m]
  SecondMoments second_moments;
  double torsion_constant;             ///< J [m⁴]
  double warping_constant;             ///< Γ [m⁶]
  Eigen::Vector2d shear_centre;        ///< from the centroid, depends on ν [m]
  Eigen::Vector2d trefftz_centre;      ///< from the centroid, does not [m]
  ShearFlexibility shear_flexibility;  ///< α by energy
};

/// What one mesh gave.
struct SectionLevel {
  int triangles, nodes;
  SectionProperties properties;
};

/// How much halving the mesh last changed a figure, as a share of it; of a figure near zero, of
/// what it is small against: Γ of 1e-4 (I_yy + I_zz)²/A, a centre of a tenth of the radius of
/// gyration, α_yz of a twentieth of √(α_yy α_zz). The error left is less: the change over 2^p - 1,
/// p the order of convergence (4 with smooth solutions).
struct SectionErrors {
  double torsion_constant, warping_constant, shear_centre, shear_flexibility;
  [[nodiscard]] double largest() const;
};

struct SectionAnalysis {
  SectionProperties properties;  ///< of the finest mesh
  SectionErrors errors;
  std::vector<SectionLevel> levels;   ///< from the coarsest mesh to the finest
  bool converged;                     ///< every figure is finite, and errors.largest() <= tolerance
  [[nodiscard]] bool finite() const;  ///< every figure of the finest mesh is a finite number
};

struct SectionAnalysisOptions {
  double reference_poisson = 0.3;  ///< ν_ref, of G_ref
  double tolerance = 2e-4;         ///< of the last change, > 0
  int most_nodes = 600'000;        ///< no mesh is refined beyond
  int least_levels = 2;            ///< meshes at least, >= 2
};

/// From one mesh: quadratic triangles, one Cholesky factorisation by CHOLMOD. The solutions are
/// known up to a constant; the value at one node is set to zero, which changes nothing else.
/// `regions` are those that mesh.regions counts. Throws std::invalid_argument for regions that are
/// too few and a mesh without area.
[[nodiscard]] SectionProperties section_properties(const TriangleMesh& mesh,
                                                   std::span<const Region> regions,
                                                   double reference_poisson);

/// Halves the mesh, graded to its corners, until the figures stay; or until one is not finite, or
/// their changes show that the meshes left would not settle them. Throws as section_properties
/// does, and for options out of range.
[[nodiscard]] SectionAnalysis analyse_section(TriangleMesh mesh, std::span<const Region> regions,
                                              const SectionAnalysisOptions& options = {});

}  // namespace wheeltap::fem
