// Modes of one structure from several set-ups of sensors that share references.
//
// Each set-up is identified by itself and the modes are put together afterwards (PoSER: Reynders,
// Magalhães, De Roeck & Cunha 2009, IMAC 27; with uncertainty, Döhler, Lam & Mevel 2013, Mech.
// Syst. Signal Process. 36:562): records need neither the same start nor the same excitation.
//
// Frequencies and damping: weighted means x̄ = Σ w_s x_s / Σ w_s, w_s = 1/(v_s + τ²), τ² the
// variance between set-ups beyond their own, v_s (DerSimonian & Laird 1986). Shapes: set-up s holds
// a factor a_s that it cannot know. With r_s its part at the references and r their mean,
//   a_s = r_sᴴ r / r_sᴴ r_s,   φ_k = Σ_s u_s a_s φ_{s,k} / Σ_s u_s  over the set-ups that have k,
// where u_s is the inverse variance of r_s. Covariances follow from those of the set-ups, which are
// independent, by the derivatives (of the shapes, by central differences).
#pragma once

#include <vector>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// What one set-up found, and which of all sensors each of its channels is.
struct SetUpModes {
  std::vector<Mode> modes = {};
  Eigen::MatrixXd covariance = {};  ///< of all frequencies, then all damping ratios
  std::vector<int> sensors = {};    ///< by channel
};

/// Why a merged mode is not to be trusted at once.
enum class MergeDoubt {
  few_set_ups,   ///< found in less than half of the set-ups
  doubted,       ///< doubtful in most of those that found it
  inconsistent,  ///< frequencies scatter between set-ups beyond what they say of themselves
  unlike         ///< two set-ups' shapes differ at the references: MAC below 0.8
};

struct MergedMode {
  double frequency_hz = 0.0, frequency_sd = 0.0;
  double damping = 0.0, damping_sd = 0.0;
  double between_hz = 0.0;       ///< τ of the frequency
  double consistency_p = 1.0;    ///< of χ² = Σ (f_s - f̄)² / v_s; 1 in one set-up alone
  double reference_mac = 1.0;    ///< the least between two set-ups, at the references
  double collinearity = 0.0;     ///< modal phase collinearity of the whole shape
  std::vector<int> places = {};  ///< by set-up: among its modes; -1: not found
  Eigen::VectorXcd shape = {};   ///< by sensor, largest entry 1; NaN where no set-up tells
  Eigen::MatrixXd shape_covariance = {};  ///< of real parts, then imaginary parts; 0 where NaN
  std::vector<MergeDoubt> doubts = {};

  [[nodiscard]] int found() const;
};

struct MergedModes {
  std::vector<MergedMode> modes = {};  ///< by frequency
  Eigen::MatrixXd covariance = {};     ///< of all frequencies, then all damping ratios
  std::vector<int> references = {};    ///< sensors that every set-up has
};

/// Modes of two set-ups are the same where their frequencies are within 2 % or five standard
/// deviations, and |Δf|/f + 1 - MAC at the references is small (average_linkage to 0.15). Of a mode
/// that some set-ups lack, the shape has gaps. `sensors`: how many there are in all. Throws
/// std::invalid_argument for no set-up, a sensor beyond `sensors` or twice in one set-up, and
/// set-ups that have no sensor in common.
[[nodiscard]] MergedModes merge_modes(const std::vector<SetUpModes>& set_ups, int sensors);

}  // namespace wheeltap::signals
