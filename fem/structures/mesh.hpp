// Meshing of a structure of members, and assembly of its matrices.
#pragma once

#include <array>
#include <vector>

#include "fem/beam/timoshenko_element.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// The strains of one element of a member: one due to the axial force, one due to the torque, and
/// in each plane one due to a constant moment and one due to a constant shear force. An element has
/// three strains in a plane structure, and six in a three-dimensional structure.
enum class ElementStrain { axial, bending_z, shear_z, torsion, bending_y, shear_y };
inline constexpr int kElementStrains = 6;

/// Returns the flexural properties of an element of this length, for a deflection along z (bending
/// about y) if `along_z` is true, or along y (bending about z) if it is false.
[[nodiscard]] Flexure<double> flexure(const Member::Piece& piece, double length, bool along_z,
                                      bool rotary_inertia);

/// A meshed structure. The mesh provides the positions of the elements, and the displacements of
/// points of the structure.
class Mesh {
 public:
  struct Element {
    int member;
    double from, to;  ///< ends of the element [m from the member's first end]
    /// Index of each strain in `Discretisation::strains`; -1 for a strain that the element does not
    /// have.
    std::array<int, kElementStrains> strains;
    int piece;  ///< index of the segment in `Member::pieces`
  };

  /// Meshes a structure. Throws InvalidStructure.
  explicit Mesh(const Structure& structure);

  [[nodiscard]] const Structure& structure() const { return structure_; }
  [[nodiscard]] const Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  /// Returns the index of the first element of a member. If `member` is the number of members,
  /// returns the number of elements.
  [[nodiscard]] int first_element(int member) const {
    return first_element_[static_cast<std::size_t>(member)];
  }
  [[nodiscard]] double member_length(int member) const;

  /// Returns the element that contains the position s [m] of a member. Element e covers [s_e,
  /// s_{e+1}); the last element includes its end. A position within 1e-9 member lengths of a
  /// boundary counts as this boundary. Throws std::invalid_argument outside the member.
  [[nodiscard]] int element_at(int member, double s) const;

  /// Returns the deflections and slopes (w₁, w₁', w₂, w₂') at the ends of an element, for a
  /// deflection along the z axis or the y axis of the section.
  [[nodiscard]] std::array<SparseRow, 4> bending_motions(int element, bool along_z) const;

  /// Returns the indices of the strains of the rotational springs at a node: springs between the
  /// node and member ends (joints of finite stiffness), and springs to ground.
  [[nodiscard]] const std::vector<int>& joint_strains(int node) const {
    return joint_strains_[static_cast<std::size_t>(node)];
  }

  /// Returns the displacement of a node as a row; the row is empty if it is restrained.
  [[nodiscard]] const SparseRow& motion(int node, Direction direction) const;
  /// Returns the displacement along (or the rotation about) a global axis at a point of a member,
  /// computed with the shape functions of the element.
  [[nodiscard]] SparseRow motion(int member, double s, Direction direction) const;
  /// Returns the displacement of a point of a member along any unit vector, or its rotation about
  /// this vector.
  [[nodiscard]] SparseRow motion(int member, double s, const Vector3& axis, bool rotation) const;
  /// Returns the x, y, z axes of a member in global coordinates.
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
  /// The six displacements and rotations of each node, then of each boundary between elements.
  std::vector<std::array<SparseRow, kDirections>> node_motions_;
  std::vector<std::vector<std::array<SparseRow, kDirections>>> station_motions_;
  std::vector<MemberFrame> frames_;
  std::vector<std::vector<double>> boundaries_;
};

}  // namespace wheeltap::fem
