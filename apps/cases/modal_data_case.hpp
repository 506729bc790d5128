// Measured modes of a case: sensors, frequencies, shapes and their uncertainty.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Modes that are simulated from the case's truth instead of measured, with the scatter to use if
/// the case gives no value.
struct SimulatedModes {
  std::vector<double> frequencies_hz;
  Eigen::MatrixXd shapes = {};       ///< one row per mode; empty: no sensors
  double cov = 0.0, shape_sd = 0.0;  ///< > 0
};

/// Parses the data at `where`, e.g. /data. If the data have no frequencies and shapes, those of
/// `simulated` are used; without `simulated` they remain empty until the truth is simulated. Throws
/// Failure (65) for sensors that are not on the structure, inconsistent sizes and invalid
/// covariances.
[[nodiscard]] identification::ModalData parse_modal_data(
    const CaseFile& file, const Pointer& where, const identification::AnyStructure& structure,
    const SimulatedModes* simulated = nullptr);

/// Throws Failure for a "doubt" without shapes. Call it after the truth is simulated.
void require_shapes_to_doubt(const CaseFile& file, const Pointer& where, bool shapes);

}  // namespace wheeltap::apps
