// Causes of a change: damage, an added mass, a faulty sensor, or none of these causes.
//
//   damage, mass:  δ = δ(kind, place, severity)                       (defect_shifts.hpp)
//   feature fault: δ = e_j s,       s ~ N(0, (size · residual sd_j)²)
//   thermometer: δ = -J_c b + ε,  b ~ N(0, (size · sd of the covariate)²), J_c the slopes of the
//                  features, ε as below: the effect of an offset depends on weather
//   other:         δ = δ(damage) + ε,  ε ~ N(0, κ² V), V the covariance of the measured shift
//
// P(cause | rows) ∝ P(cause) ∫ L(δ) p(δ | cause) dδ, with L the likelihood of shift_likelihood.hpp,
// including all normalising constants. Along a path of severities, δ is piecewise linear. L is a
// mixture of normal densities, so that the integrals are exact. "Other" has the equally probable
// sizes κ = 1, 2, 4 … 128. κ is the distance of the shift from the nearest damage, in standard
// deviations of the shift. Without the cause "other", a shift far from every damage would count as
// damage whenever all other causes were less probable.
#pragma once

#include "identification/monitoring/causes/defect_shifts.hpp"
#include "identification/monitoring/shift_likelihood.hpp"

namespace wheeltap::identification::monitoring {

/// Prior probabilities of the causes of a change, up to a factor.
struct CauseWeights {
  double damage = 0.3, mass = 0.3, sensor = 0.3, other = 0.1;
};

struct CauseOptions {
  CauseWeights weights = {};
  std::vector<bool> is_mass = {};  ///< one per kind; true: an added mass, false: damage
  /// One per kind: its prior share among the kinds of damage, or among the kinds of added mass.
  std::vector<double> share = {};
  Eigen::VectorXd residual_sd = {};   ///< p
  Eigen::VectorXd covariate_sd = {};  ///< c entries, training period; zero: covariate not used
};

/// Quantiles of a posterior.
struct CentralInterval {
  double q5 = 0.0, q50 = 0.0, q95 = 0.0;
};

/// A part of a defect kind's line of sites, such as a structural member.
struct ExplainedPlace {
  int stretch = 0;
  double probability = 0.0;  ///< probability of the part, given the kind
  CentralInterval at = {};   ///< location [m] along the part, given the part
};

/// A kind of defect as the cause of the change.
struct ExplainedDefect {
  double probability = 0.0;
  std::vector<double> by_cell = {};  ///< probability of each cell of the line, given the kind
  CentralInterval location = {};     ///< location on the kind's line, given the kind
  CentralInterval severity = {};
  /// Parts with a probability of at least 1 %, the most probable first
  std::vector<ExplainedPlace> places = {};
};

struct ChangeExplanation {
  double damage = 0.0, mass = 0.0, sensor = 0.0, other = 0.0;  ///< P(cause | change); the sum is 1
  std::vector<ExplainedDefect> defects = {};                   ///< one per kind
  /// Probabilities of faults, one per feature and one per covariate
  std::vector<double> feature_faults = {}, covariate_faults = {};
  /// Distance of the measured shift from the nearest damage, in standard deviations of the shift.
  double distance_to_damage = 0.0;
};

/// `slopes`: p x c, AlarmRecord::covariate_slopes.
[[nodiscard]] ChangeExplanation explain_change(const ShiftLikelihood& likelihood,
                                               const Eigen::MatrixXd& slopes,
                                               const std::vector<DefectKind>& kinds,
                                               const std::vector<DefectPath>& paths,
                                               const CauseOptions& options);

}  // namespace wheeltap::identification::monitoring
