// Triangulates the outline of a section by CGAL's constrained Delaunay triangulation.
//
// This is a separate library, wheeltap::fem_sections, because CGAL's triangulations are GPL-3.
#pragma once

#include "fem/sections/outline.hpp"
#include "fem/sections/triangle_mesh.hpp"

namespace wheeltap::fem {

struct SectionMeshOptions {
  double coarseness = 0.3;  ///< longest edge relative to √area, > 0
  double angle =
      22.0;  ///< smallest angle [degrees], in (0, 30]; sharper corners of the outline remain
  int most_points = 100'000;
};

/// Ruppert's Delaunay refinement (1995, J. Algorithms 18:548) with exact predicates. It halves
/// edges until their diametral circles contain no corner of an adjacent triangle, and inserts the
/// circumcentres of bad triangles. It considers only the interior, so the two faces of a slit do
/// not cause refinement of each other. Edges at a sharp corner are split at distances from it that
/// are powers of two, so that the refinement terminates.
///
/// Checks the outline with `checked` first. Throws std::invalid_argument like `checked`, for
/// options out of range, a section in several pieces, a region that is negligibly small compared
/// with the others, and an outline whose mesh would have more than `most_points`.
[[nodiscard]] TriangleMesh section_mesh(const Outline& outline,
                                        const SectionMeshOptions& options = {});

}  // namespace wheeltap::fem
