// Structure definition: nodes, members, supports, springs and masses, in two or three dimensions.
#pragma once

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/structures/vector3.hpp"

namespace wheeltap::fem {

/// The direction of a node's displacement: along or about a global axis. A plane structure has the
/// directions x, y and rz.
enum class Direction { x, y, z, rx, ry, rz };
inline constexpr int kDirections = 6;
[[nodiscard]] constexpr bool is_rotation(Direction d) {
  return d >= Direction::rx;
}
/// Returns the name of a direction: "x" … "rz"; "rotation" for rz of a plane structure.
[[nodiscard]] std::string direction_name(Direction d, int dimension);

/// Cross-section properties of a member in its own axes (y, z); x runs along the member. The axes
/// are the principal axes, and the shear centre is the centroid. In a plane structure, z lies in
/// the plane and y is normal to the plane, so `second_moment_y` determines bending.
struct MemberSection {
  static constexpr double kNoShear = std::numeric_limits<double>::infinity();

  double area = 0.0;              ///< A [m²]
  double second_moment_y = 0.0;   ///< I_y = ∫ z² dA [m⁴]: deflection along z
  double second_moment_z = 0.0;   ///< I_z = ∫ y² dA [m⁴]: deflection along y; 3D only
  double torsion_constant = 0.0;  ///< J [m⁴], three-dimensional only
  double shear_coefficient_z =
      kNoShear;  ///< κ_z [-]: shear stiffness κ_z G A along z; ∞: no shear deformation
  double shear_coefficient_y = kNoShear;  ///< κ_y [-], 3D only
  double depth = 0.0;                     ///< outer dimension along z [m], for cracks; 0 if unknown
};

struct Node {
  std::string name;
  Vector3 at = {};  ///< position [m]; z = 0 in a plane structure
};

/// The connection of a member's end to its node.
struct MemberEnd {
  static constexpr double kRigid = std::numeric_limits<double>::infinity();

  /// Vector of the rigid arm from the node to the member's end, in global axes [m].
  Vector3 offset = {};
  /// Rotational stiffness of the joint about the member's own x, y, z [N·m/rad]: ∞ is a rigid
  /// joint, and 0 a hinge. Members of a plane structure bend about their y axis.
  std::array<double, 3> rotation = {kRigid, kRigid, kRigid};
};

/// A straight Timoshenko beam-column between two nodes.
struct Member {
  /// A segment of the member with its own material and section. The segment extends from the end of
  /// the previous segment (or from the first node) up to `to`.
  struct Piece {
    double to;  ///< end of the segment [m from the first end]; the last segment ends at the second
                ///< end
    Material material;
    MemberSection section;
  };

  std::string name;
  std::array<int, 2> nodes = {};  ///< indices of `Structure::nodes`
  int elements = 1;  ///< number of elements of equal length; ends of segments are additional
                     ///< boundaries
  std::vector<Piece> pieces = {};  ///< at least one segment
  /// For three-dimensional structures: the z axis of the section is the component of `up` normal to
  /// the member. `up` = 0 means global z, or global y if the member is parallel to z.
  Vector3 up = {};
  std::array<MemberEnd, 2> ends = {};
  double axial_force = 0.0;  ///< axial force N, positive in tension [N]: geometric stiffness N ∫
                             ///< w'² dx
  double foundation = 0.0;   ///< stiffness of the elastic foundation along the section's axes y and
                             ///< z [N/m²]
};

/// A support that restrains a node rigidly or by springs to ground.
struct NodeSupport {
  int node = 0;
  std::array<bool, kDirections> fix = {};
  std::array<double, kDirections> stiffness = {};  ///< [N/m], [N·m/rad]; 0: no spring
};

struct NodeMass {
  int node = 0;
  double mass = 0.0;     ///< [kg]
  Vector3 inertia = {};  ///< rotary inertia about x, y, z [kg·m²]
};

/// A massless spring between two nodes, or from a node to ground (`nodes[1]` = kGround). The spring
/// acts along the line between the nodes, or on their relative displacement in one direction.
struct NodeSpring {
  static constexpr int kGround = -1;
  static constexpr int kAlong = -1;

  std::array<int, 2> nodes = {0, kGround};
  int direction = kAlong;  ///< static_cast<int>(Direction), or kAlong: along the line between the
                           ///< nodes
  double stiffness = 0.0;  ///< [N/m], [N·m/rad]
};

/// A structure of members. All values are in SI units.
struct Structure {
  enum class Mass {
    consistent,  ///< ρA and ρI integrated with the shape functions
    lumped       ///< mass ρA l / 2 at each end of an element; no rotary inertia
  };

  int dimension = 2;  ///< 2: x, y; 3: x, y, z
  std::vector<Node> nodes;
  std::vector<Member> members;
  std::vector<NodeSupport> supports = {};
  std::vector<NodeMass> masses = {};
  std::vector<NodeSpring> springs = {};
  Mass mass = Mass::consistent;
  bool rotary_inertia = true;  ///< for consistent masses: true includes ρI
  bool axial = true;           ///< for plane structures: true allows displacements along x
};

/// Thrown for an invalid structure; holds the faulty part, with the reason as message.
class InvalidStructure : public std::invalid_argument {
 public:
  enum class Part { whole, nodes, members, supports, masses, springs };

  InvalidStructure(Part part, int index, const std::string& message)
      : std::invalid_argument(message), part_(part), index_(index) {}
  [[nodiscard]] Part part() const { return part_; }
  /// Index of the faulty part in the list of parts of its kind; undefined for `whole`.
  [[nodiscard]] int index() const { return index_; }

 private:
  Part part_;
  int index_;
};

/// Checks a structure. Throws InvalidStructure with the faulty part, the value and the allowed
/// range.
void validate(const Structure& structure);

/// The axes of a member: the rows are the member's x, y, z axes in global coordinates. `length` is
/// the distance between the ends of the member [m]; it excludes the rigid arms.
struct MemberFrame {
  std::array<Vector3, 3> axes;
  double length;
};
/// Computes the local axes of a member. Throws InvalidStructure for a member without length, or
/// with `up` parallel to the member.
[[nodiscard]] MemberFrame member_frame(const Structure& structure, int member);

/// Returns the boundaries of a member's elements, as distances from the first end of the member
/// [m]: 0 … length, ascending.
[[nodiscard]] std::vector<double> element_boundaries(const Structure& structure, int member);

/// Converts a beam to the equivalent plane structure. The structure lies along x from 0, deflects
/// along y, and has no motion along x. Each member extends from one support of the beam to the
/// next, with the elements of the beam between these supports. `depth` is the depth of the section,
/// for cracks. Throws std::invalid_argument for supports between nodes of the beam's mesh.
[[nodiscard]] Structure as_structure(const Beam& beam, double depth = 0.0);

}  // namespace wheeltap::fem
