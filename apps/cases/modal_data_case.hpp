// The measured modes of a case: sensors, frequencies, shapes, and their scatter.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Modes of the case's truth in place of measured ones, and the scatter for which the case gives no
/// value.
struct SimulatedModes {
  std::vector<double> frequencies_hz;
  Eigen::MatrixXd shapes = {};       ///< a row a mode; empty: no sensors
  double cov = 0.0, shape_sd = 0.0;  ///< > 0
};

/// What stands at `where`, /data say. Without frequencies and shapes they are those of `simulated`,
/// or left empty, for a truth to fill in. Throws Failure (65) for sensors that are not on the
/// structure, numbers that do not go together, and covariances that are none.
[[nodiscard]] identification::ModalData parse_modal_data(
    const CaseFile& file, const Pointer& where, const identification::AnyStructure& structure,
    const SimulatedModes* simulated = nullptr);

/// Refuses a "doubt" of modes without shapes, once what a truth simulates is there.
void require_shapes_to_doubt(const CaseFile& file, const Pointer& where, bool shapes);

}  // namespace wheeltap::apps
