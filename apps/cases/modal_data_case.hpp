// Measured modes of a case: sensors, frequencies, shapes and their uncertainty.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Modes simulated from the `truth` of the case, in place of measured modes. If the case gives no
/// standard deviations, those of the simulated modes are used.
struct SimulatedModes {
  std::vector<double> frequencies_hz;
  Eigen::MatrixXd shapes = {};  ///< mode shapes, one row per mode; empty without sensors
  /// Standard deviations of frequencies (relative) and of shape entries, > 0
  double cov = 0.0, shape_sd = 0.0;
};

/// Parses the data at `where`, e.g. /data. If the data have neither frequencies nor shapes, those
/// of `simulated` are used. Without `simulated`, the data remain empty until modes are
/// simulated. Throws Failure (65) for sensors that are not on the structure, inconsistent sizes and
/// invalid covariances.
[[nodiscard]] identification::ModalData parse_modal_data(
    const CaseFile& file, const Pointer& where, const identification::AnyStructure& structure,
    const SimulatedModes* simulated = nullptr);

/// Throws Failure for data with "doubt" but without shapes. Call this function after the simulation
/// of the truth.
void require_shapes_to_doubt(const CaseFile& file, const Pointer& where, bool shapes);

}  // namespace wheeltap::apps
