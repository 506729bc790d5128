// Structure definition: nodes, members, supports, springs and masses, in the plane or in space.
#pragma once

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/structures/vector3.hpp"

namespace wheeltap::fem {

/// A motion of a node, along or about a global axis. A plane structure has x, y and rz.
enum class Direction { x, y, z, rx, ry, rz };
inline constexpr int kDirections = 6;
[[nodiscard]] constexpr bool is_rotation(Direction d) {
  return d >= Direction::rx;
}
/// "x" … "rz"; "rotation" for rz of a plane structure.
[[nodiscard]] std::string direction_name(Direction d, int dimension);

/// Cross-section properties of a member in its own axes (y, z); x runs along the member. The axes
/// are principal, and the shear centre is the centroid. In a plane structure z lies in the plane
/// and y is normal to it, so `second_moment_y` governs bending.
struct MemberSection {
  static constexpr double kNoShear = std::numeric_limits<double>::infinity();

  double area = 0.0;              ///< A [m²]
  double second_moment_y = 0.0;   ///< I_y = ∫ z² dA [m⁴]: deflection along z
  double second_moment_z = 0.0;   ///< I_z = ∫ y² dA [m⁴]: deflection along y; in space
  double torsion_constant = 0.0;  ///< J [m⁴], in space
  double shear_coefficient_z =
      kNoShear;  ///< κ_z [-]: shear stiffness κ_z G A along z; ∞: no shear deformation
  double shear_coefficient_y = kNoShear;  ///< κ_y [-], in space
  double depth = 0.0;                     ///< outer size along z [m], for cracks; 0 where unknown
};

struct Node {
  std::string name;
  Vector3 at = {};  ///< [m]; z = 0 in the plane
};

/// The connection of a member's end to its node.
struct MemberEnd {
  static constexpr double kRigid = std::numeric_limits<double>::infinity();

  /// Rigid arm from the node to the member's end, in global axes [m].
  Vector3 offset = {};
  /// Rotational stiffness of the joint about the member's own x, y, z [N·m/rad]: ∞ is rigid, 0 a
  /// hinge. A plane structure bends about y.
  std::array<double, 3> rotation = {kRigid, kRigid, kRigid};
};

/// A straight Timoshenko beam-column between two nodes.
struct Member {
  /// Material and section from the end of the previous piece (or the first node) up to `to`.
  struct Piece {
    double to;  ///< [m] from the first end; the last piece ends at the second end
    Material material;
    MemberSection section;
  };

  std::string name;
  std::array<int, 2> nodes = {};  ///< indices of `Structure::nodes`
  int elements = 1;  ///< of equal length; the end of a piece is an element boundary, too
  std::vector<Piece> pieces = {};  ///< at least one
  /// In space: the section's z axis is the component of `up` normal to the member. Zero selects
  /// global z, or global y if the member is parallel to z.
  Vector3 up = {};
  std::array<MemberEnd, 2> ends = {};
  double axial_force = 0.0;  ///< N, tension positive [N]: geometric stiffness N ∫ w'² dx
  double foundation = 0.0;   ///< elastic foundation along the section's axes y and z [N/m²]
};

/// Restrains a node, rigidly or by springs to ground.
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

/// A massless spring between two nodes, or from a node to ground (`nodes[1]` = kGround): along the
/// line between the nodes, or on the difference of one motion.
struct NodeSpring {
  static constexpr int kGround = -1;
  static constexpr int kAlong = -1;

  std::array<int, 2> nodes = {0, kGround};
  int direction = kAlong;  ///< static_cast<int>(Direction), or along the line
  double stiffness = 0.0;  ///< [N/m], [N·m/rad]
};

/// A structure of members. Units are SI.
struct Structure {
  enum class Mass {
    consistent,  ///< ρA and ρI through the shape functions
    lumped       ///< half of ρA l at each end of an element; no rotary inertia
  };

  int dimension = 2;  ///< 2: x, y; 3: x, y, z
  std::vector<Node> nodes;
  std::vector<Member> members;
  std::vector<NodeSupport> supports = {};
  std::vector<NodeMass> masses = {};
  std::vector<NodeSpring> springs = {};
  Mass mass = Mass::consistent;
  bool rotary_inertia = true;  ///< for consistent masses: include ρI
  bool axial = true;           ///< for plane structures: allow motion along x
};

/// An invalid structure: the faulty part and what is wrong with it.
class InvalidStructure : public std::invalid_argument {
 public:
  enum class Part { whole, nodes, members, supports, masses, springs };

  InvalidStructure(Part part, int index, const std::string& message)
      : std::invalid_argument(message), part_(part), index_(index) {}
  [[nodiscard]] Part part() const { return part_; }
  /// Index in the list of parts of this kind; undefined for `whole`.
  [[nodiscard]] int index() const { return index_; }

 private:
  Part part_;
  int index_;
};

/// Throws InvalidStructure with the part, the value and the allowed range.
void validate(const Structure& structure);

/// Axes of a member: the rows are its own x, y, z in global coordinates. `length` is the distance
/// between its ends, without offsets [m].
struct MemberFrame {
  std::array<Vector3, 3> axes;
  double length;
};
/// Throws InvalidStructure for a member without length, or with `up` along it.
[[nodiscard]] MemberFrame member_frame(const Structure& structure, int member);

/// Boundaries of a member's elements from its first end [m]: 0 … length, ascending.
[[nodiscard]] std::vector<double> element_boundaries(const Structure& structure, int member);

/// The plane structure equivalent to a beam: along x from 0, deflecting along y, without motion
/// along x. Members span between its supports, with the beam's elements. `depth` is the height of
/// its section, for cracks. Throws std::invalid_argument for supports between nodes of the beam's
/// mesh.
[[nodiscard]] Structure as_structure(const Beam& beam, double depth = 0.0);

}  // namespace wheeltap::fem
