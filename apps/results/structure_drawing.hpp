// A structure as points and lines, with the motion of every point: what pictures and words of mode
// shapes are made of.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

struct StructureDrawing {
  struct Point {
    std::string place;  ///< "B", "beam at 0.5 m", "mass 2"
    fem::Vector3 at;    ///< [m]
    std::array<fem::SparseRow, 3> translation, rotation;
    bool node;  ///< a node, or a mass of a chain
  };
  int dimension = 2;
  std::vector<Point> points;            ///< nodes first, in their order
  std::vector<std::vector<int>> lines;  ///< of points; one a member, then one a spring or link
  std::vector<std::string> line_names;
  double size = 1.0;                ///< the largest extent [m]
  std::vector<fem::DofName> names;  ///< of the degrees of freedom
};

/// A structure, its matrices, and what is drawn of it. Matrices have no places: they are degrees of
/// freedom by name, and nothing is drawn. A chain is drawn upwards, a metre a mass, moving along x.
struct DrawnStructure {
  fem::Discretisation discretisation;
  StructureDrawing drawing;
};
/// Throws fem::InvalidStructure.
[[nodiscard]] DrawnStructure drawn(const identification::AnyStructure& structure);

/// What moves most in a shape (a node within 1 % of it, where there is one), and which way: "beam
/// at 0.5 m, y", "node B, x and y", "rotation of post at 0.5 m about y".
[[nodiscard]] std::string largest_motion(const StructureDrawing& drawing,
                                         const Eigen::VectorXd& shape);

/// Of each node (mass, or named place) the motions in a shape, by direction.
struct NodeMotion {
  std::string node;
  std::vector<std::pair<std::string, double>> motions;
};
[[nodiscard]] std::vector<NodeMotion> node_motions(const StructureDrawing& drawing,
                                                   const Eigen::VectorXd& shape);

/// Displacement of every point in a shape, the largest scaled to 1 (all 0 where nothing moves).
[[nodiscard]] std::vector<fem::Vector3> point_motions(const StructureDrawing& drawing,
                                                      const Eigen::VectorXd& shape);

/// Legacy VTK polydata (The VTK User's Guide, "VTK file formats"): members as polylines, and one
/// vector field of displacements a mode, scaled to a largest one of 1. Throws std::invalid_argument
/// for a structure that has no places.
[[nodiscard]] std::string vtk_text(const StructureDrawing& drawing,
                                   const fem::StructureModes& modes, const std::string& title);

}  // namespace wheeltap::apps
