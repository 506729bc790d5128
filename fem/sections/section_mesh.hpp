// Triangles over the outline of a section, by CGAL's constrained Delaunay triangulation.
//
// A library of its own, wheeltap::fem_sections: CGAL's triangulations are GPL-3.
#pragma once

#include "fem/sections/outline.hpp"
#include "fem/sections/triangle_mesh.hpp"

namespace wheeltap::fem {

struct SectionMeshOptions {
  double coarseness = 0.3;  ///< longest edge as a share of √area, > 0
  double angle = 22.0;      ///< smallest angle sought [degrees], in (0, 30]; sharper corners stay
  int most_points = 100'000;
};

/// Ruppert's Delaunay refinement (1995, J. Algorithms 18:548) with predicates that are exact: edges
/// are halved until no corner of a triangle beside them lies within their diametral circle, and
/// circumcentres of bad triangles are added. The refinement looks at the inside alone, so that the
/// two faces of a slit do not refine each other. Edges at a sharp corner are split in shells of
/// powers of two.
///
/// The outline is held against `checked` first. Throws std::invalid_argument for what that refuses,
/// for options out of range, for a section in several pieces, for a region that is nothing beside
/// the others, and for an outline whose mesh would have more than `most_points`.
[[nodiscard]] TriangleMesh section_mesh(const Outline& outline,
                                        const SectionMeshOptions& options = {});

}  // namespace wheeltap::fem
