// The cross-section of a case: a shape with sizes, or an outline.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"
#include "fem/sections/outline.hpp"
#include "fem/sections/section_analysis.hpp"

namespace wheeltap::apps {

/// What a section's moduli relate to. Young's modulus and density may be unknown to a file that
/// holds a section alone.
struct SectionMaterial {
  double poisson;
  std::optional<double> young = {};
  std::optional<double> density = {};
};

/// "width", "height", … of the section at `where`, all of them and no others. Throws Failure.
void check_sizes(const CaseFile& file, const Pointer& where);

/// A section by its sizes, at `where`: A, I about the width, Cowper's κ. Throws Failure.
[[nodiscard]] fem::Section parse_sized_section(const CaseFile& file, const Pointer& where,
                                               double poisson);

/// The outline of a "polygon", or of a shape with sizes (y along the width, the origin in the
/// middle; circles as polygons of equal area). Throws Failure.
[[nodiscard]] fem::Outline parse_outline(const CaseFile& file, const Pointer& where,
                                         const SectionMaterial& material);

struct MeshedSection {
  fem::Outline outline;
  fem::TriangleMesh mesh;  ///< the coarsest
  fem::SectionAnalysis analysis;
};
/// Throws Failure for an outline that is none; for a program built without CGAL, too.
[[nodiscard]] MeshedSection analyse(const CaseFile& file, const Pointer& where,
                                    const SectionMaterial& material);

struct BeamSection {
  fem::Section section;
  double density;  ///< that gives the beam its mass per length with the section's area
};
/// As a plane beam has it: bending about y (the width), shear along z.
[[nodiscard]] BeamSection parse_beam_section(const CaseFile& file, const Pointer& where,
                                             const fem::Material& material);

}  // namespace wheeltap::apps
