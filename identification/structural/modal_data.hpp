// What was measured of a structure's modes, and how far from the model's they may be.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "inference/model/prior.hpp"

namespace wheeltap::identification {

/// One motion that was measured.
struct Sensor {
  std::string name;  ///< "B, x"
  fem::SparseRow motion;
};

/// A scatter: a number, or unknown, with a prior.
struct Scatter {
  double value = 0.0;
  std::optional<inference::Prior> prior = {};

  [[nodiscard]] bool known() const { return !prior.has_value(); }
  [[nodiscard]] bool none() const { return known() && value == 0.0; }
};

/// Modes in the order in which they are given. Without shapes row i is mode i + 1 of the structure.
/// A row without frequency and shape is a gap: it holds the number of a mode that was not measured,
/// or that was measured and is not used.
struct ModalData {
  std::vector<double> frequencies_hz = {};  ///< NaN where there is none
  /// Of the frequencies [Hz²], modes × modes; of those that are NaN, anything. Empty where `cov` is
  /// unknown.
  Eigen::MatrixXd covariance = {};
  std::optional<inference::Prior> cov_prior = {};  ///< of the coefficient of variation

  std::vector<Sensor> sensors = {};
  /// Modes × sensors, of any scale and sign; NaN where not measured. Empty: no shapes.
  Eigen::MatrixXd shapes = {};
  /// Of each shape, scaled to a largest measured entry of 1: sensors × sensors. Where `shape_sd` is
  /// unknown, of a scatter of 1.
  std::vector<Eigen::MatrixXd> shape_covariances = {};
  std::optional<inference::Prior> shape_sd_prior = {};

  /// What the model itself leaves out, beside the noise: a coefficient of variation of each
  /// frequency, independent from mode to mode, and an sd of shapes' entries.
  Scatter discrepancy = {}, shape_discrepancy = {};
  /// By how much the error that moves frequencies by `discrepancy` mixes modes: see ModalMixing.
  Scatter mixing = {};
  /// Sd of what each piece of the structure is stiffer or softer than the model has it, relative:
  /// see StiffnessErrors.
  Scatter stiffness_discrepancy = {};

  /// P, before the data, that a measured mode is none of the structure's (a harmonic, a pole of the
  /// noise). Goes with shapes.
  double doubt = 0.0;

  int predict = 0;                       ///< further modes to be foretold
  std::vector<double> held_out_hz = {};  ///< of these, what was measured; NaN where nothing was
  bool simulated = false;                ///< made from the case's truth
  std::string origin = {};               ///< in words

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] bool has_shapes() const { return shapes.size() > 0; }
  [[nodiscard]] bool is_gap(int mode) const {
    return std::isnan(frequencies_hz[static_cast<std::size_t>(mode)]) &&
           !(mode < shapes.rows() && (shapes.row(mode).array() == shapes.row(mode).array()).any());
  }
  /// Rows that are no gaps.
  [[nodiscard]] int measured_modes() const {
    int count = 0;
    for (int i = 0; i < modes(); ++i) count += is_gap(i) ? 0 : 1;
    return count;
  }
  /// Modes that the structure must have: with shapes, gaps are matched to none.
  [[nodiscard]] int least_modes() const { return has_shapes() ? measured_modes() : modes(); }
};

}  // namespace wheeltap::identification
