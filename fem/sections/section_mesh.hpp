// Triangulation of the outline of a section by CGAL's constrained Delaunay triangulation.
// This code is a separate library, wheeltap::fem_sections, because CGAL's triangulations have the
// licence GPL-3.
#pragma once

#include "fem/sections/outline.hpp"
#include "fem/sections/triangle_mesh.hpp"

namespace wheeltap::fem {

struct SectionMeshOptions {
  double coarseness = 0.3;  ///< longest edge divided by √area, > 0
  double angle = 22.0;  ///< smallest angle of a triangle [degrees], in (0, 30]; sharper corners of
                        ///< the outline remain
  int most_points = 100'000;
};

/// Meshes a section by Ruppert's Delaunay refinement (1995, J. Algorithms 18:548) with exact
/// predicates. The algorithm halves edges until their diametral circles contain no corner of an
/// adjacent triangle, and inserts the circumcentres of triangles with too small angles or too long
/// edges. The algorithm considers only the interior, so that refinement on one side of a slit does
/// not spread to the other side. Edges at a sharp corner are split at distances from the corner
/// that are powers of two, so that the refinement terminates.
///
/// Checks the outline with `checked` first. Throws std::invalid_argument in the same cases as
/// `checked`. Also throws std::invalid_argument for options out of range, a section of several
/// unconnected parts, a region that is negligibly small compared with the others, and an outline
/// whose mesh would have more than `most_points` points.
[[nodiscard]] TriangleMesh section_mesh(const Outline& outline,
                                        const SectionMeshOptions& options = {});

}  // namespace wheeltap::fem
