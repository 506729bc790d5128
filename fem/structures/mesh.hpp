// Meshes a structure of members and assembles its matrices.
#pragma once

#include <array>
#include <vector>

#include "fem/beam/timoshenko_element.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// The strains of one element of a member: an axial force, a torque, and in each plane a constant
/// moment and a constant shear force. A plane structure has three, a spatial structure six.
enum class ElementStrain { axial, bending_z, shear_z, torsion, bending_y, shear_y };
inline constexpr int kElementStrains = 6;

/// Flexural properties of an element of this length in one plane of the section: deflection along z
/// with bending about y, or deflection along y with bending about z.
[[nodiscard]] Flexure<double> flexure(const Member::Piece& piece, double length, bool along_z,
                                      bool rotary_inertia);

/// A meshed structure: the positions of its elements, and the motions of places on it.
class Mesh {
 public:
  struct Element {
    int member;
    double from, to;  ///< [m] from the member's first end
    /// Index of each strain in `Discretisation::strains`; -1 if it does not exist.
    std::array<int, kElementStrains> strains;
    int piece;  ///< piece of the member
  };

  /// Throws InvalidStructure.
  explicit Mesh(const Structure& structure);

  [[nodiscard]] const Structure& structure() const { return structure_; }
  [[nodiscard]] const Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  /// Index of the first element of a member; for member = `members`, the number of elements.
  [[nodiscard]] int first_element(int member) const {
    return first_element_[static_cast<std::size_t>(member)];
  }
  [[nodiscard]] double member_length(int member) const;

  /// The element of a member that contains s [m]: element e covers [s_e, s_{e+1}), the last one
  /// closed. An s within 1e-9 of the member's length of a boundary counts as that boundary. Throws
  /// std::invalid_argument outside the member.
  [[nodiscard]] int element_at(int member, double s) const;

  /// (w₁, w₁', w₂, w₂') of an element's ends, for a deflection along the section's z, or along y.
  [[nodiscard]] std::array<SparseRow, 4> bending_motions(int element, bool along_z) const;

  /// The strains of the rotational springs at a node: of member ends joined there with a finite
  /// stiffness, and of springs to ground.
  [[nodiscard]] const std::vector<int>& joint_strains(int node) const {
    return joint_strains_[static_cast<std::size_t>(node)];
  }

  /// The motion of a node as a row; empty if it is restrained.
  [[nodiscard]] const SparseRow& motion(int node, Direction direction) const;
  /// The motion of a place on a member along (or about) a global axis, through the element's shape
  /// functions.
  [[nodiscard]] SparseRow motion(int member, double s, Direction direction) const;
  /// The motion of a place on a member along (or about) an arbitrary unit vector.
  [[nodiscard]] SparseRow motion(int member, double s, const Vector3& axis, bool rotation) const;
  /// The member's own x, y, z in global coordinates.
  [[nodiscard]] const std::array<Vector3, 3>& member_axes(int member) const {
    return frames_[static_cast<std::size_t>(member)].axes;
  }

 private:
  friend class MeshBuilder;
  Structure structure_;
  Discretisation discretisation_;
  std::vector<Element> elements_;
  std::vector<int> first_element_;
  std::vector<std::vector<int>> joint_strains_;  // one list per node
  /// The six motions of each node, then of each boundary between elements.
  std::vector<std::array<SparseRow, kDirections>> node_motions_;
  std::vector<std::vector<std::array<SparseRow, kDirections>>> station_motions_;
  std::vector<MemberFrame> frames_;
  std::vector<std::vector<double>> boundaries_;
};

}  // namespace wheeltap::fem
