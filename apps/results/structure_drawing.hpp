// Sentences and files about the mode shapes of a structure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/structure_drawing.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

using fem::DrawnStructure;
using fem::StructureDrawing;
using identification::drawn;

/// Returns the location and the direction of the largest motion in a mode shape. A node is
/// preferred if its motion is within 1 % of the largest motion. Examples of results: "beam at
/// 0.5 m, y", "node B, x and y", "rotation of post at 0.5 m about y".
[[nodiscard]] std::string largest_motion(const StructureDrawing& drawing,
                                         const Eigen::VectorXd& shape);

/// The displacements of a node (mass, or named location) in a mode shape, by direction.
struct NodeMotion {
  std::string node;
  std::vector<std::pair<std::string, double>> motions;
};
[[nodiscard]] std::vector<NodeMotion> node_motions(const StructureDrawing& drawing,
                                                   const Eigen::VectorXd& shape);

/// Returns legacy VTK polydata (The VTK User's Guide, "VTK file formats"): members as polylines and
/// one vector field of displacements per mode, with a maximum of 1. Throws std::invalid_argument
/// for a structure given by matrices, which has no coordinates.
[[nodiscard]] std::string vtk_text(const StructureDrawing& drawing,
                                   const fem::StructureModes& modes, const std::string& title);

}  // namespace wheeltap::apps
