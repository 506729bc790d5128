// A beam with unknown coefficients: E, density, springs of its supports.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "fem/beam/beam.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

struct ParametricBeam {
  fem::Beam beam = {};  ///< at the medians of the priors
  double depth = 0.0;   ///< height of its section, where one is given
  std::shared_ptr<const identification::StructureModel> model = {};
  bool uniform = true;  ///< no spring is unknown: the beam is as symmetric as at the medians
};

/// The beam at /beam, names in place of young, density and springs standing for /parameters. Throws
/// Failure for names that there are not, and priors that reach beyond what a coefficient may be.
[[nodiscard]] ParametricBeam parse_parametric_beam(const CaseFile& file);

}  // namespace wheeltap::apps
