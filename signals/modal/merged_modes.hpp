// Merges the modes of several sensor set-ups that share reference sensors.
//
// Each set-up is identified separately, and then the modes are merged (PoSER: Reynders, Magalhães,
// De Roeck & Cunha 2009, IMAC 27; with uncertainty, Döhler, Lam & Mevel 2013, Mech. Syst. Signal
// Process. 36:562). The records need neither the same start nor the same excitation.
//
// Frequencies and damping: weighted means x̄ = Σ w_s x_s / Σ w_s, w_s = 1/(v_s + τ²), with the
// variances v_s of the set-ups and the additional variance τ² between them (DerSimonian & Laird
// 1986). Shapes: the shape of each set-up s has an unknown factor a_s. With r_s its entries at the
// references and r the mean of all r_s,
//   a_s = r_sᴴ r / r_sᴴ r_s,   φ_k = Σ_s u_s a_s φ_{s,k} / Σ_s u_s  over the set-ups with sensor k,
// where u_s is the inverse variance of r_s. Covariances follow from those of the independent
// set-ups by derivatives (for shapes, by central differences).
#pragma once

#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// The results of one set-up, with the sensor of each channel.
struct SetUpModes {
  std::vector<Mode> modes = {};
  Eigen::MatrixXd covariance = {};  ///< all frequencies, then all damping ratios
  std::vector<int> sensors = {};    ///< by channel
};

/// Reasons to doubt a merged mode.
enum class MergeDoubt {
  few_set_ups,   ///< found in less than half of the set-ups
  doubted,       ///< doubtful in most set-ups that found it
  inconsistent,  ///< scatter of frequencies between set-ups exceeds their standard deviations
  unlike         ///< two set-ups' shapes differ at the references: MAC below 0.8
};

struct MergedMode {
  double frequency_hz = 0.0, frequency_sd = 0.0;
  double damping = 0.0, damping_sd = 0.0;
  double between_hz = 0.0;       ///< τ of the frequency
  double consistency_p = 1.0;    ///< of χ² = Σ (f_s - f̄)² / v_s; 1 in one set-up alone
  double reference_mac = 1.0;    ///< the smallest MAC between two set-ups at the references
  double collinearity = 0.0;     ///< modal phase collinearity of the whole shape
  std::vector<int> places = {};  ///< one per set-up: index among its modes; -1: not found
  Eigen::VectorXcd shape = {};   ///< by sensor, largest entry 1; NaN if no set-up measured it
  Eigen::MatrixXd shape_covariance = {};  ///< of real parts, then imaginary parts; 0 where NaN
  std::vector<MergeDoubt> doubts = {};

  [[nodiscard]] int found() const;
};

struct MergedModes {
  std::vector<MergedMode> modes = {};  ///< by frequency
  Eigen::MatrixXd covariance = {};     ///< all frequencies, then all damping ratios
  std::vector<int> references = {};    ///< sensors that every set-up has
};

/// Modes of two set-ups match if their frequencies differ by less than 2 % or five standard
/// deviations, and |Δf|/f + 1 - MAC at the references is small (average_linkage to 0.15). If some
/// set-ups lack a mode, its shape has gaps. `sensors`: total number of sensors. Throws
/// std::invalid_argument for no set-up, a sensor outside `sensors` or repeated in one set-up, and
/// set-ups without a common sensor.
[[nodiscard]] MergedModes merge_modes(const std::vector<SetUpModes>& set_ups, int sensors);

}  // namespace wheeltap::signals
