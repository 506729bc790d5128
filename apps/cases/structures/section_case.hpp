// Cross-section of a case: a shape with sizes, or an outline.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"
#include "fem/sections/outline.hpp"
#include "fem/sections/section_analysis.hpp"

namespace wheeltap::apps {

/// The reference material of a section. A file that holds only a section may lack Young's modulus
/// and density.
struct SectionMaterial {
  double poisson;
  std::optional<double> young = {};
  std::optional<double> density = {};
};

/// Checks that the section at `where` has all sizes of its shape ("width", "height", …) and no
/// others. Throws Failure.
void check_sizes(const CaseFile& file, const Pointer& where);

/// Parses a section with sizes at `where`: A, I about the width, Cowper's κ. Throws Failure.
[[nodiscard]] fem::Section parse_sized_section(const CaseFile& file, const Pointer& where,
                                               double poisson);

/// Parses the outline of a "polygon", or makes that of a shape with sizes (y along the width,
/// origin in the middle; circles as polygons of equal area). Throws Failure.
[[nodiscard]] fem::Outline parse_outline(const CaseFile& file, const Pointer& where,
                                         const SectionMaterial& material);

struct MeshedSection {
  fem::Outline outline;
  fem::TriangleMesh mesh;  ///< the coarsest mesh
  fem::SectionAnalysis analysis;
};
/// Meshes and analyses a section. Throws Failure for an invalid outline, and in a build without
/// CGAL.
[[nodiscard]] MeshedSection analyse(const CaseFile& file, const Pointer& where,
                                    const SectionMaterial& material);

struct BeamSection {
  fem::Section section;
  double density;  ///< times the section's area: mass per length of the beam
};
/// Parses the section of a plane beam: bending about y (the width), shear along z.
[[nodiscard]] BeamSection parse_beam_section(const CaseFile& file, const Pointer& where,
                                             const fem::Material& material);

}  // namespace wheeltap::apps
