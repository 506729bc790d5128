// A beam with unknown coefficients: Young's modulus, density, stiffnesses of support springs.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

struct ParametricBeam {
  fem::Beam beam = {};  ///< beam with its unknown coefficients at the medians of their priors
  double depth = 0.0;   ///< depth of the section, if the case gives it
  std::shared_ptr<const identification::StructureModel> model = {};
  bool uniform =
      /// True if no spring stiffness is unknown. Without unknown springs, the symmetry of the beam
      /// is the same at all parameter values as at the prior medians.
      true;
};

/// Parses the beam at /beam, in which young, density and springs may be names of /parameters.
/// Throws Failure for an unknown name, and for a prior that exceeds the bounds of its coefficient.
[[nodiscard]] ParametricBeam parse_parametric_beam(const CaseFile& file);

}  // namespace wheeltap::apps
