// Measured modes of a structure and their noise parameters.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "inference/model/prior.hpp"

namespace wheeltap::identification {

struct RepeatedTests;

/// A sensor and the displacement or rotation that it measures.
struct Sensor {
  std::string name;  ///< "B, x"
  fem::SparseRow motion;
};

/// A noise parameter: a known number, or an unknown with a prior.
struct Scatter {
  double value = 0.0;
  std::optional<inference::Prior> prior = {};

  [[nodiscard]] bool known() const { return !prior.has_value(); }
  [[nodiscard]] bool none() const { return known() && value == 0.0; }
};

/// Measured modes in the order of the case. Without shapes, row i is mode i + 1 of the structure. A
/// row without frequency and shape is a gap: a mode number that was not measured or is not used.
struct ModalData {
  std::vector<double> frequencies_hz = {};  ///< NaN if not measured
  /// Covariance of the frequencies [Hz²], modes × modes; undefined for NaN frequencies. Empty if
  /// `cov` is unknown.
  Eigen::MatrixXd covariance = {};
  std::optional<inference::Prior> cov_prior = {};  ///< prior of sd divided by frequency

  std::vector<Sensor> sensors = {};
  /// Modes × sensors, at arbitrary scale and sign. NaN: not measured. Empty: no shapes.
  Eigen::MatrixXd shapes = {};
  /// Covariance of each shape, scaled to a largest measured entry of 1: sensors × sensors. If
  /// `shape_sd` is unknown, the matrices are the covariances for `shape_sd` = 1.
  std::vector<Eigen::MatrixXd> shape_covariances = {};
  std::optional<inference::Prior> shape_sd_prior = {};

  /// Model errors in addition to the noise: the relative sd of each frequency (errors of different
  /// modes are independent), and the sd of shape entries.
  Scatter discrepancy = {}, shape_discrepancy = {};
  /// Factor κ of the mixing of mode shapes; see mixing_sd. The model error causes this mixing and
  /// also changes the frequencies by `discrepancy`.
  Scatter mixing = {};
  /// Relative standard deviation of the stiffness error of each part of the structure; see
  /// StiffnessErrors.
  Scatter stiffness_discrepancy = {};

  /// Prior probability that a measured mode is spurious (a harmonic, a noise pole). Spurious modes
  /// require shapes.
  double doubt = 0.0;

  /// The repeated tests from which frequencies and covariance were inferred; null if the case has
  /// no "repeats".
  std::shared_ptr<const RepeatedTests> repeats = {};

  int predict = 0;  ///< number of further modes that are predicted
  std::vector<double> held_out_hz =
      {};                   ///< measured frequencies of these further modes; NaN if not measured
  bool simulated = false;   ///< true: simulated with the true values of the case
  std::string origin = {};  ///< origin of the data, in words

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] bool has_shapes() const { return shapes.size() > 0; }
  [[nodiscard]] bool is_gap(int mode) const {
    return std::isnan(frequencies_hz[static_cast<std::size_t>(mode)]) &&
           !(mode < shapes.rows() && (shapes.row(mode).array() == shapes.row(mode).array()).any());
  }
  /// Number of modes with a measured frequency or a measured shape.
  [[nodiscard]] int measured_modes() const {
    int count = 0;
    for (int i = 0; i < modes(); ++i) count += is_gap(i) ? 0 : 1;
    return count;
  }
  /// Number of modes that the structure must have. Unmeasured modes (is_gap) count only if no
  /// shapes were measured.
  [[nodiscard]] int least_modes() const { return has_shapes() ? measured_modes() : modes(); }
};

}  // namespace wheeltap::identification
