// What a structure is: nodes, members, supports, springs and masses, in the plane or in space.
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

/// What a member's cross-section resists, in its own axes (y, z); x runs along the member. Axes are
/// principal, the shear centre is the centroid. Of a plane structure, z lies in the plane and y is
/// normal to it, so that `second_moment_y` bends.
struct MemberSection {
  static constexpr double kNoShear = std::numeric_limits<double>::infinity();

  double area = 0.0;                      ///< A [m²]
  double second_moment_y = 0.0;           ///< I_y = ∫ z² dA [m⁴]: deflection along z
  double second_moment_z = 0.0;           ///< I_z = ∫ y² dA [m⁴]: deflection along y; in space
  double torsion_constant = 0.0;          ///< J [m⁴], in space
  double shear_coefficient_z = kNoShear;  ///< κ_z [-]: shear stiffness κ_z G A along z; ∞: stiff
  double shear_coefficient_y = kNoShear;  ///< κ_y [-], in space
  double depth = 0.0;                     ///< outer size along z [m], for cracks; 0 where unknown
};

struct Node {
  std::string name;
  Vector3 at = {};  ///< [m]; z = 0 in the plane
};

/// How a member's end is joined to its node.
struct MemberEnd {
  static constexpr double kRigid = std::numeric_limits<double>::infinity();

  /// From the node to the member's end, global axes, rigid [m].
  Vector3 offset = {};
  /// Stiffness of the joint against rotation about the member's own x, y, z [N·m/rad]: ∞ is rigid,
  /// 0 a hinge. A plane structure bends about y.
  std::array<double, 3> rotation = {kRigid, kRigid, kRigid};
};

/// A straight Timoshenko beam-column between two nodes.
struct Member {
  /// Material and section from the piece before (or the first node) up to `to`.
  struct Piece {
    double to;  ///< [m] from the first end; the last piece reaches the second end
    Material material;
    MemberSection section;
  };

  std::string name;
  std::array<int, 2> nodes = {};   ///< indices of `Structure::nodes`
  int elements = 1;                ///< equal ones; an end of a piece is a boundary, too
  std::vector<Piece> pieces = {};  ///< at least one
  /// In space: the section's z axis is the part of `up` normal to the member. Zero stands for
  /// global z, or global y where the member is parallel to z.
  Vector3 up = {};
  std::array<MemberEnd, 2> ends = {};
  double axial_force = 0.0;  ///< N, tension positive [N]: geometric stiffness N ∫ w'² dx
  double foundation = 0.0;   ///< elastic foundation along the section's axes y and z [N/m²]
};

/// Holds a node, rigidly or by springs to ground.
struct NodeSupport {
  int node = 0;
  std::array<bool, kDirections> fix = {};
  std::array<double, kDirections> stiffness = {};  ///< [N/m], [N·m/rad]; 0 where there is none
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
  bool rotary_inertia = true;  ///< of consistent masses: whether ρI counts
  bool axial = true;           ///< of a plane structure: whether anything moves along x
};

/// What is wrong with a structure, and where.
class InvalidStructure : public std::invalid_argument {
 public:
  enum class Part { whole, nodes, members, supports, masses, springs };

  InvalidStructure(Part part, int index, const std::string& message)
      : std::invalid_argument(message), part_(part), index_(index) {}
  [[nodiscard]] Part part() const { return part_; }
  /// Of the part's list; meaningless for `whole`.
  [[nodiscard]] int index() const { return index_; }

 private:
  Part part_;
  int index_;
};

/// Throws InvalidStructure naming the part, the value and the range that is allowed.
void validate(const Structure& structure);

/// Axes of a member: rows are its own x, y, z in global coordinates. `length` is that between its
/// ends, offsets taken off [m].
struct MemberFrame {
  std::array<Vector3, 3> axes;
  double length;
};
/// Throws InvalidStructure for a member without length, or with `up` along it.
[[nodiscard]] MemberFrame member_frame(const Structure& structure, int member);

/// Boundaries of a member's elements from its first end [m]: 0 … length, ascending.
[[nodiscard]] std::vector<double> element_boundaries(const Structure& structure, int member);

/// The plane structure that a beam is: along x from 0, deflecting along y, nothing moving along x;
/// members between its supports, with elements as the beam's. `depth` is its section's height, for
/// cracks. Throws std::invalid_argument for supports between nodes of the beam's mesh.
[[nodiscard]] Structure as_structure(const Beam& beam, double depth = 0.0);

}  // namespace wheeltap::fem
