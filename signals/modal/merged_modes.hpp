// Merging of the modes of several sensor set-ups that share reference sensors.
//
// The modes of each set-up are identified separately, and then merged (PoSER: Reynders, Magalhães,
// De Roeck & Cunha 2009, IMAC 27; with uncertainty, Döhler, Lam & Mevel 2013, Mech. Syst. Signal
// Process. 36:562). The records of the set-ups may have different start times and excitations.
// Merged frequencies and damping ratios are weighted means x̄ = Σ w_s x_s / Σ w_s over the set-ups
// s, with w_s = 1/(v_s + τ²). v_s is the variance of the estimate of set-up s, and τ² is the
// additional variance between set-ups (DerSimonian & Laird 1986). The shape of each set-up s is
// known only up to a factor a_s. Let r_s be the entries of this shape at the references, r the mean
// of all r_s, and u_s the inverse variance of r_s. Then
//   a_s = r_sᴴ r / r_sᴴ r_s,   φ_k = Σ_s u_s a_s φ_{s,k} / Σ_s u_s  over the set-ups with sensor k,
// The set-ups are statistically independent. The covariances of the merged results follow from the
// set-ups' covariances and the derivatives of the merged results (for shapes, central differences).
#pragma once

#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// The modes of one set-up, with the sensor of each channel.
struct SetUpModes {
  std::vector<Mode> modes = {};
  Eigen::MatrixXd covariance = {};  ///< covariance of all frequencies, then all damping ratios
  std::vector<int> sensors = {};    ///< sensor of each channel
  int covariance_samples = 0;       ///< as ModalResult::covariance_samples
};

/// Reasons to doubt a merged mode.
enum class MergeDoubt {
  few_set_ups,   ///< identified in less than half of the set-ups
  doubted,       ///< doubtful in most set-ups in which the mode was identified
  inconsistent,  ///< frequencies differ between set-ups by more than their standard deviations
                 ///< explain
  unlike         ///< shapes of two set-ups differ at the references: MAC below 0.8
};

struct MergedMode {
  double frequency_hz = 0.0, frequency_sd = 0.0;
  double damping = 0.0, damping_sd = 0.0;
  double between_hz = 0.0;     ///< standard deviation τ of the frequency between set-ups
  double consistency_p = 1.0;  ///< p-value of χ² = Σ (f_s - f̄)² / v_s; 1 for a single set-up
  double reference_mac = 1.0;  ///< the smallest MAC between two set-ups at the references
  double collinearity = 0.0;   ///< modal phase collinearity of the whole shape
  std::vector<int> places = {};  ///< per set-up: index of the mode in the set-up; -1: not
                                 ///< identified
  Eigen::VectorXcd shape = {};   ///< one entry per sensor, largest entry 1; NaN for sensors without
                                 ///< a measured entry
  Eigen::MatrixXd shape_covariance = {};  ///< covariance of real parts, then imaginary parts; 0 for
                                          ///< entries that are NaN
  std::vector<MergeDoubt> doubts = {};

  [[nodiscard]] int found() const;
};

struct MergedModes {
  std::vector<MergedMode> modes = {};  ///< merged modes by ascending frequency
  Eigen::MatrixXd covariance = {};     ///< covariance of all frequencies, then damping ratios
  std::vector<int> references = {};    ///< sensors that occur in every set-up
  int covariance_samples = 0;          ///< the smallest number of a set-up; 0: none has samples
};

/// Merges the modes of several set-ups. Modes of two set-ups match under two conditions. Their
/// frequencies differ by less than 2 % or five standard deviations. The mean distance |Δf|/f + 1 -
/// MAC at the references is at most 0.15 (average_linkage). If a mode is not identified in some
/// set-ups, the merged shape has no entries (NaN) at the sensors that only these set-ups have.
/// `sensors` is the total number of sensors. Throws std::invalid_argument for an empty list of
/// set-ups, set-ups without a common sensor, and a sensor number that is out of range or occurs
/// twice in one set-up.
[[nodiscard]] MergedModes merge_modes(const std::vector<SetUpModes>& set_ups, int sensors);

}  // namespace wheeltap::signals
