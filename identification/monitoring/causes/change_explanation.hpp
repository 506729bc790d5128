// Causes of a change: damage, an added mass, a faulty sensor, or another cause.
//
//   damage, mass:  δ = δ(kind, place, severity)                       (defect_shifts.hpp)
//   feature fault: δ = e_j s,       s ~ N(0, (size · residual sd_j)²)
//   thermometer: δ = -J_c b + ε,  b ~ N(0, (size · sd of the covariate)²), J_c the slopes of the
//                  features; ε as below, because the effect of an offset depends on weather
//   other:         δ = δ(damage) + ε,  ε ~ N(0, κ² V), V the covariance of the measured shift
//
// P(cause | rows) ∝ P(cause) ∫ L(δ) p(δ | cause) dδ, with L the likelihood of shift_likelihood.hpp,
// including all normalising constants. Along a path (defect_shifts.hpp), δ is piecewise linear in
// the severity. L is a mixture of normal densities. The integrals therefore have a closed form. For
// the cause "other", the values κ = 1, 2, 4 … 128 are equally probable. κ is the standard deviation
// of the difference ε between the shift and the shift due to damage, divided by the standard
// deviation of the measured shift. Without the cause "other", a shift that no damage
// can cause would count as damage whenever damage is more probable than the remaining causes.
#pragma once

#include "identification/monitoring/causes/defect_shifts.hpp"
#include "identification/monitoring/shift_likelihood.hpp"

namespace wheeltap::identification::monitoring {

/// Prior weights of the causes of a change, proportional to probabilities.
struct CauseWeights {
  double damage = 0.3, mass = 0.3, sensor = 0.3, other = 0.1;
};

struct CauseOptions {
  CauseWeights weights = {};
  std::vector<bool> is_mass = {};  ///< one per kind; true: an added mass, false: damage
  /// Prior weight of each kind among the kinds of damage, or among the kinds of added mass.
  std::vector<double> share = {};
  Eigen::VectorXd residual_sd = {};   ///< p
  Eigen::VectorXd covariate_sd = {};  ///< of c covariates in the training period; 0 if not used
};

/// Quantiles of a posterior distribution.
struct CentralInterval {
  double q5 = 0.0, q50 = 0.0, q95 = 0.0;
};

/// A part of the line on which a defect kind is possible, for example a structural member.
struct ExplainedPlace {
  int stretch = 0;
  double probability = 0.0;  ///< probability of the part, given the kind
  CentralInterval at = {};   ///< location [m] from the start of the part, given the part
};

/// Posterior of a defect of one kind as the cause of the change.
struct ExplainedDefect {
  double probability = 0.0;
  std::vector<double> by_cell = {};  ///< probability of each cell of the line, given the kind
  CentralInterval location = {};     ///< position on the kind's line, given the kind
  CentralInterval severity = {};
  /// Parts with a probability of at least 1 %, the most probable first
  std::vector<ExplainedPlace> places = {};
};

struct ChangeExplanation {
  double damage = 0.0, mass = 0.0, sensor = 0.0, other = 0.0;  ///< P(cause | change); the sum is 1
  std::vector<ExplainedDefect> defects = {};                   ///< one per kind
  /// Probability of a fault of each feature, and of each covariate's sensor
  std::vector<double> feature_faults = {}, covariate_faults = {};
  /// Distance between the measured shift and the nearest shift that a damage can cause, in standard
  /// deviations of the measured shift.
  double distance_to_damage = 0.0;
};

/// Computes the probabilities of the causes. `slopes` are AlarmRecord::covariate_slopes, p x c.
[[nodiscard]] ChangeExplanation explain_change(const ShiftLikelihood& likelihood,
                                               const Eigen::MatrixXd& slopes,
                                               const std::vector<DefectKind>& kinds,
                                               const std::vector<DefectPath>& paths,
                                               const CauseOptions& options);

}  // namespace wheeltap::identification::monitoring
