// modes.json: modes with covariances; written by `wheeltap modal`, read by damage and update cases.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report_json.hpp"
#include "signals/modal/merged_modes.hpp"

namespace wheeltap::apps {

/// The sensor that belongs to one entry of every mode shape.
struct MeasuredSensor {
  std::string name = {};  ///< name of the sensor's channel
  std::string node = {}, direction = {};
  std::optional<double> azimuth = {}, elevation = {};  ///< direction of the sensor [degrees]
  bool reference = false;
  std::string unit = {};  ///< unit of the measured numbers; empty: unknown
  /// Measured quantity: "displacement", "velocity", "acceleration"; empty: unknown
  std::string quantity = {};
};

/// Contents of a modes.json file: the result of a modal identification.
struct ModesFile {
  std::string title = {};
  std::vector<MeasuredSensor> sensors = {};
  std::vector<int> numbers = {};  ///< mode numbers, ascending, at least 1; empty: 1, 2, …
  /// Frequencies and damping ratios; a damping ratio is NaN if unknown
  Eigen::VectorXd frequencies_hz = {}, damping = {};
  /// Covariance of the vector that has all frequencies, then all damping ratios; empty if the
  /// identification method does not compute it.
  Eigen::MatrixXd covariance = {};
  /// Mode shapes, one column per mode, scaled to a largest entry of 1; NaN: not measured
  Eigen::MatrixXcd shapes = {};
  /// Covariance matrix of each shape, with the real parts first, then the imaginary parts; empty if
  /// `covariance` is empty.
  std::vector<Eigen::MatrixXd> shape_covariance = {};
  std::string quantity = {};  ///< quantity of all shapes; empty: unknown
  std::vector<bool> doubtful = {};
  int blocks = 0;  ///< number of blocks of the record in the covariance estimate; 0: unknown
};

[[nodiscard]] ModesFile measured_modes(const signals::ModalResult& result,
                                       const std::vector<MeasuredSensor>& sensors);
[[nodiscard]] ModesFile measured_modes(const signals::MergedModes& merged,
                                       const std::vector<MeasuredSensor>& sensors);

[[nodiscard]] Report modes_json(const ModesFile& modes);

/// Reads a modes.json. Throws Failure (66) for an unreadable file. Throws Failure (65), with the
/// location of the fault, for invalid content.
[[nodiscard]] ModesFile read_modes_file(const std::filesystem::path& path);

}  // namespace wheeltap::apps
