// Beam definition: material, cross-section, length, mesh and supports.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace wheeltap::fem {

/// A linear elastic, isotropic material.
struct Material {
  double young;    ///< Young's modulus E [Pa], > 0
  double poisson;  ///< Poisson's ratio ν [-], -1 < ν < 0.5
  double density;  ///< mass density ρ [kg/m³], > 0

  /// Shear modulus G = E / (2 (1 + ν)) [Pa].
  [[nodiscard]] double shear_modulus() const { return young / (2.0 * (1.0 + poisson)); }
};

/// Cross-section properties for bending and shear; `section.hpp` computes the properties of common
/// cross-sections.
struct Section {
  double area;               ///< A [m²]
  double second_moment;      ///< I about the bending axis [m⁴]
  double shear_coefficient;  ///< κ [-]: the shear stiffness is κ G A
};

/// A support at the location `at`. The support restrains deflection, rotation or both: rigidly, or
/// by a spring if `stiffness` is set.
struct Support {
  double at;                        ///< location [m], anywhere in [0, length], also between nodes
  bool deflection = true;           ///< true: restrains the deflection w
  bool rotation = false;            ///< true: restrains the rotation θ
  std::optional<double> stiffness;  ///< spring stiffness [N/m for w, N·m/rad for θ]; empty: rigid
};

/// A straight prismatic Timoshenko beam meshed with equal two-node elements.
struct Beam {
  double length;  ///< L [m], > 0
  int elements;   ///< number of equal elements, >= 1
  std::vector<Support> supports;
  Material material;
  Section section;

  [[nodiscard]] int nodes() const { return elements + 1; }
  [[nodiscard]] double element_length() const { return length / elements; }

  /// Returns the index (from 0) of the element that contains x. Element e covers [x_e, x_{e+1});
  /// the last element includes its end. An x within 1e-9 L of a node counts as this node. Throws
  /// std::invalid_argument for x outside [0, L].
  [[nodiscard]] int element_at(double x) const;

  /// Returns the midpoint of element e [m].
  [[nodiscard]] double element_midpoint(int e) const { return (e + 0.5) * element_length(); }
};

/// Returns the supports of a named type: "simply-supported", "cantilever" (clamped at 0),
/// "clamped-clamped", "clamped-pinned" (clamped at 0), "free-free". Throws std::invalid_argument
/// for any other name.
[[nodiscard]] std::vector<Support> named_supports(std::string_view name, double length);

/// True if the intact beam is symmetric under x → L - x. Natural frequencies then cannot
/// distinguish a defect from its mirror image.
[[nodiscard]] bool is_mirror_symmetric(const Beam& beam);

/// Checks a beam. Throws std::invalid_argument for the first value that is out of range; the
/// message gives the value and the allowed range.
void validate(const Beam& beam);

}  // namespace wheeltap::fem
