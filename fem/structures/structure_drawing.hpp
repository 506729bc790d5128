// Drawing of a structure as points and lines, with the displacement of every point in a mode shape.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/matrix_structure.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {

struct StructureDrawing {
  struct Point {
    enum class On { node, member, mass, ground };
    On on;
    std::string name = {};  ///< name of the node or member; number of the mass, from 1
    double along = 0.0;     ///< distance from the member's start [m]
    Vector3 at;             ///< position [m]
    std::array<SparseRow, 3> translation, rotation;

    [[nodiscard]] bool is_node() const { return on == On::node || on == On::mass; }
    [[nodiscard]] Vector3 moved(const Eigen::VectorXd& shape) const;   ///< translations
    [[nodiscard]] Vector3 turned(const Eigen::VectorXd& shape) const;  ///< rotations
  };
  int dimension = 2;
  std::vector<Point> points;            ///< nodes first, in their order
  std::vector<std::vector<int>> lines;  ///< indices of points; one line per member, then one line
                                        ///< per spring or link
  double size = 1.0;                    ///< the largest extent [m]
  std::vector<DofName> names;           ///< one per degree of freedom
};

/// The matrices and the drawing of a structure. A structure given by matrices has no drawing,
/// because its degrees of freedom have no positions. A chain of masses is drawn as a vertical line,
/// with a distance of one metre between masses; the masses move along x.
struct DrawnStructure {
  Discretisation discretisation;
  StructureDrawing drawing;
};
/// Discretises and draws a structure. Throws InvalidStructure.
[[nodiscard]] DrawnStructure drawn(const Structure& structure);
[[nodiscard]] DrawnStructure drawn(const LumpedChain& chain);
[[nodiscard]] DrawnStructure drawn(const MatrixStructure& matrices);

/// Computes the displacement of every point in a mode shape, scaled to a largest displacement of 1.
/// If the shape is zero, all displacements are 0.
[[nodiscard]] std::vector<Vector3> point_motions(const StructureDrawing& drawing,
                                                 const Eigen::VectorXd& shape);

}  // namespace wheeltap::fem
