// Rotational spring models of an open edge crack.
#pragma once

#include <span>
#include <string_view>

namespace wheeltap::fem {

/// A model of an edge crack of depth a in a section of depth h. The crack causes a relative
/// rotation c per unit of bending moment,
///
///   c = 6 π (h / E I) J(a/h),   J(x) = ∫₀ˣ s F(s)² ds  [rad/(N·m)],
///
/// from Castigliano's theorem and the stress intensity K = σ √(π a) F(a/h) of an edge crack in
/// bending. This compliance c is for plane stress; for plane strain, c is (1 - ν²) times this
/// value.
struct CrackLaw {
  std::string_view name;                   ///< name in a case file
  std::string_view source;                 ///< paper, section
  double (*integral)(double depth_ratio);  ///< J
  bool plane_strain = false;
};

/// Returns all crack models: "tada" (Tada, Paris & Irwin: F = √(tan(πs/2)/(πs/2)) (.923 + .199 (1 -
/// sin(πs/2))⁴)/cos(πs/2)), "tada-plane-strain", and "ostachowicz-krawczuk" (J as a polynomial to
/// s⁸). The default is "tada".
[[nodiscard]] std::span<const CrackLaw> crack_laws();
/// Returns the crack model with this name, or nullptr for an unknown name.
[[nodiscard]] const CrackLaw* find_crack_law(std::string_view name);

/// Computes the compliance c [rad/(N·m)] of a crack for the depth ratio a/h in [0, 1), the depth h
/// of the section [m] and the bending stiffness EI [N·m²]. Throws std::invalid_argument for values
/// out of range.
[[nodiscard]] double crack_compliance(const CrackLaw& law, double depth_ratio, double height,
                                      double bending_stiffness, double poisson);

}  // namespace wheeltap::fem
