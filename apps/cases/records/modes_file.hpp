// modes.json: modes with the covariance of all that is known of them, as `modal` writes it and a
// damage or update case reads it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report_json.hpp"
#include "signals/modal/merged_modes.hpp"

namespace wheeltap::apps {

/// What measured one entry of every shape.
struct MeasuredSensor {
  std::string name = {};  ///< of its channel
  std::string node = {}, direction = {};
  std::optional<double> azimuth = {}, elevation = {};  ///< [degrees]
  bool reference = false;
  std::string unit = {};      ///< of the numbers that were measured; empty: not known
  std::string quantity = {};  ///< "displacement", "velocity", "acceleration"; empty: not known
};

struct MeasuredModes {
  std::string title = {};
  std::vector<MeasuredSensor> sensors = {};
  std::vector<int> numbers = {};  ///< of the modes, ascending from 1 or more; empty: 1, 2, …
  Eigen::VectorXd frequencies_hz = {}, damping = {};  ///< damping NaN where not known
  /// Of all frequencies, then all damping ratios; empty where the method says nothing of scatter.
  Eigen::MatrixXd covariance = {};
  Eigen::MatrixXcd shapes = {};  ///< a mode a column, largest entry 1; NaN where not measured
  /// Of real parts, then imaginary parts; empty as the covariance is.
  std::vector<Eigen::MatrixXd> shape_covariance = {};
  std::string quantity = {};  ///< that all shapes are of; empty: not known
  std::vector<bool> doubtful = {};
  int blocks = 0;  ///< that the covariances were estimated from; 0: not said
};

[[nodiscard]] MeasuredModes measured_modes(const signals::ModalResult& result,
                                           const std::vector<MeasuredSensor>& sensors);
[[nodiscard]] MeasuredModes measured_modes(const signals::MergedModes& merged,
                                           const std::vector<MeasuredSensor>& sensors);

[[nodiscard]] Report modes_json(const MeasuredModes& modes);

/// Throws Failure: 66 where it cannot be read, 65, naming the place, where it is no such file.
[[nodiscard]] MeasuredModes read_modes_file(const std::filesystem::path& path);

}  // namespace wheeltap::apps
