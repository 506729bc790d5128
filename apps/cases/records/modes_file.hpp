// modes.json: modes with their covariance. `modal` writes it; damage and update cases read it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report_json.hpp"
#include "signals/modal/merged_modes.hpp"

namespace wheeltap::apps {

/// The sensor of one entry of every shape.
struct MeasuredSensor {
  std::string name = {};  ///< name of its channel
  std::string node = {}, direction = {};
  std::optional<double> azimuth = {}, elevation = {};  ///< [degrees]
  bool reference = false;
  std::string unit = {};      ///< unit of the measured numbers; empty: unknown
  std::string quantity = {};  ///< "displacement", "velocity", "acceleration"; empty: unknown
};

struct MeasuredModes {
  std::string title = {};
  std::vector<MeasuredSensor> sensors = {};
  std::vector<int> numbers = {};  ///< mode numbers, ascending, at least 1; empty: 1, 2, …
  Eigen::VectorXd frequencies_hz = {}, damping = {};  ///< damping: NaN if unknown
  /// Covariance of all frequencies, then all damping ratios; empty if the method gives none.
  Eigen::MatrixXd covariance = {};
  Eigen::MatrixXcd shapes = {};  ///< one column per mode, largest entry 1; NaN: not measured
  /// Covariance of real parts, then imaginary parts; empty if `covariance` is.
  std::vector<Eigen::MatrixXd> shape_covariance = {};
  std::string quantity = {};  ///< quantity of all shapes; empty: unknown
  std::vector<bool> doubtful = {};
  int blocks = 0;  ///< blocks that the covariances were estimated from; 0: unknown
};

[[nodiscard]] MeasuredModes measured_modes(const signals::ModalResult& result,
                                           const std::vector<MeasuredSensor>& sensors);
[[nodiscard]] MeasuredModes measured_modes(const signals::MergedModes& merged,
                                           const std::vector<MeasuredSensor>& sensors);

[[nodiscard]] Report modes_json(const MeasuredModes& modes);

/// Reads a modes.json. Throws Failure: 66 for an unreadable file; 65, naming the place, for other
/// content.
[[nodiscard]] MeasuredModes read_modes_file(const std::filesystem::path& path);

}  // namespace wheeltap::apps
