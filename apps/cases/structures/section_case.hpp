// Cross-section of a case: a shape with dimensions, or an outline.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"
#include "fem/sections/outline.hpp"
#include "fem/sections/section_analysis.hpp"

namespace wheeltap::apps {

/// The reference material of a section. A file that contains only a section may omit Young's
/// modulus and density.
struct SectionMaterial {
  double poisson;
  std::optional<double> young = {};
  std::optional<double> density = {};
};

/// Checks that the section at `where` has all dimensions of its shape ("width", "height", …) and no
/// other dimensions. Throws Failure.
void check_sizes(const CaseFile& file, const Pointer& where);

/// Parses a section with dimensions at `where`. The result has the area A, the second moment of
/// area I for bending about the width axis, and Cowper's shear coefficient κ. Throws Failure.
[[nodiscard]] fem::Section parse_sized_section(const CaseFile& file, const Pointer& where,
                                               double poisson);

/// Parses the outline of a "polygon", or computes the outline of a shape with dimensions. For
/// shapes, y is along the width, and the origin is at the centre; circles become polygons of equal
/// area. Throws Failure.
[[nodiscard]] fem::Outline parse_outline(const CaseFile& file, const Pointer& where,
                                         const SectionMaterial& material);

struct MeshedSection {
  fem::Outline outline;
  fem::TriangleMesh mesh;  ///< coarsest mesh of the analysis
  fem::SectionAnalysis analysis;
};
/// Meshes and analyses a section. Throws Failure for an invalid outline, and in a build without
/// CGAL.
[[nodiscard]] MeshedSection analyse(const CaseFile& file, const Pointer& where,
                                    const SectionMaterial& material);

struct BeamSection {
  fem::Section section;
  double density;  ///< (mass per length of the beam) / (area of the section)
};
/// Parses the section of a plane beam: bending about y (the width), shear along z.
[[nodiscard]] BeamSection parse_beam_section(const CaseFile& file, const Pointer& where,
                                             const fem::Material& material);

}  // namespace wheeltap::apps
