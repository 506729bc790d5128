// When features shifted: one filter for each candidate onset.
//
//   y_tj = baseline_tj + r(t - τ) δ_j,   t >= τ
//
//   step: r = 1;   ramp: r = min(1, (t - τ)/kRampHours);   transient: r = exp(-(t -
//   τ)/kTransientHours)
//
// A transient is no change: thaw, wind, traffic or a fault of identification that passes. The model
// without a change is a mixture of the baseline and of transients that began at any row; a change
// must explain the data better than all of these. A transient that has decayed gives its
// probability back to the baseline; so does, each row, the share that may have ended earlier.
//
// A shift enters linearly. The innovations of a filter without a shift are then v_t + G_t δ, G_t by
// a recursion that is common to all values of δ (Friedland 1969; Willsky & Jones 1976). A candidate
// keeps the sensitivity F of the state to δ and the posterior of δ, which is exact for Gaussian
// noise. δ is, a priori,
//
//   with probability 1/2 of all features, δ_j ~ N(0, (s r_j)²), else of one of them, each equally
//   probable;  s is one of kShiftSizes, equally probable;  r_j the residual sd of feature j.
//
// For Student t, predictive densities are normalised as in baseline_filter.hpp. The noise inflation
// of an entry's update is shared by all candidates (their mean, weighted by posterior mass), and
// the one without a change has its own: after damage its entries are no outliers to the candidates.
//
// Parameter draws are mixed with a fixed share: each row a fraction kShare of the weight is
// redistributed evenly (Herbster & Warmuth 1998), so that no draw dies out. Every predictive
// density is normalised, hence Λ_τ,t is a test martingale under the mixture without a change.
#pragma once

#include <cstdint>
#include <optional>

#include "identification/monitoring/baseline_learning.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kShiftSizes[] = {0.5, 1.5, 5.0};
inline constexpr int kSizes = 3;
inline constexpr double kRampHours = 30.0 * 24.0;
inline constexpr double kTransientHours = 72.0;

enum class ShiftProfile { step, ramp, transient };

struct ChangePointOptions {
  double hazard_per_hour = 1e-5;               ///< rate of changes
  double transients_per_hour = 12.0 / 8766.0;  ///< rate of transients; 0: none
  /// Rate at which a transient ends before it has decayed.
  double transient_ends_per_hour = 1.0 / kTransientHours;
  double ramp_share = 0.25;  ///< prior probability that a change is a ramp; 0: steps alone
  int ramp_every = 24;       ///< rows between two candidate ramps
  /// Candidates younger than this many rows are all kept; of older ones `kept_per_octave` for each
  /// doubling of age. 0: all are kept.
  int young = 16;
  int kept_per_octave = 5;
  double fixed_share = 0.01;  ///< share of the draws' weight that each row redistributes
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ChangePointOptions>
void carry(Parcel& parcel, Of& o) {
  parcel(o.hazard_per_hour, o.transients_per_hour, o.transient_ends_per_hour, o.ramp_share,
         o.ramp_every, o.young, o.kept_per_octave, o.fixed_share);
}

/// δ under one candidate and one parameter draw.
struct ShiftPosterior {
  Eigen::MatrixXd sensitivity;                   ///< F: states x p
  Eigen::MatrixXd mean;                          ///< p x kSizes, all features shift
  Eigen::MatrixXd covariance;                    ///< p x (p kSizes)
  Eigen::MatrixXd single_mean, single_variance;  ///< p x kSizes: feature j alone shifts
  /// (1 + p) x kSizes: ln of the joint posterior of draw and hypothesis, given the onset; row 0 all
  /// features, row 1 + j feature j alone.
  Eigen::MatrixXd log_weight;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ShiftPosterior>
void carry(Parcel& parcel, Of& s) {
  parcel(s.sensitivity, s.mean, s.covariance, s.single_mean, s.single_variance, s.log_weight);
}

struct CandidateOnset {
  std::int64_t row = 0;  ///< first row with the shift, counted from the start of monitoring
  double hours = 0.0;    ///< its time
  ShiftProfile profile = ShiftProfile::step;
  double log_ratio = 0.0;   ///< ln Λ
  double log_wealth = 0.0;  ///< ln of its part of the Shiryaev-Roberts sum
  /// ln of its prior probability, with what merged into it; of a transient, log_mass() is ln of its
  /// probability among the models without a change.
  double log_prior = 0.0;
  std::vector<ShiftPosterior> draws = {};
  [[nodiscard]] double log_mass() const { return log_prior + log_ratio; }
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, CandidateOnset>
void carry(Parcel& parcel, Of& c) {
  parcel(c.row, c.hours, c.profile, c.log_ratio, c.log_wealth, c.log_prior, c.draws);
}

/// Prediction of a row without a change since the last alarm.
struct PredictedRow {
  Eigen::VectorXd mean, sd;  ///< p logarithms, mixture of the draws
  Eigen::VectorXd weather;   ///< p: effect of covariates alone, posterior mean
};

/// The change since some time, given that there is one.
struct ChangeEstimate {
  double probability = 0.0;                                      ///< P(change)
  double onset_low = 0.0, onset_median = 0.0, onset_high = 0.0;  ///< hours; 2.5, 50 and 97.5 %
  double ramp_probability = 0.0;                                 ///< given a change
  Eigen::VectorXd shift, shift_sd;      ///< p, of logarithms, given a change
  Eigen::VectorXd shifted_probability;  ///< p: that the feature is among those that shift
};

class ChangePoint {
 public:
  ChangePoint() = default;
  ChangePoint(const Baseline& baseline, const ChangePointOptions& options);

  /// Takes the next row; its features may all be missing.
  PredictedRow add(const Row& row);

  /// ln Σ of the candidates' wealth: the Shiryaev-Roberts sum.
  [[nodiscard]] double log_statistic() const;
  [[nodiscard]] ChangeEstimate estimate() const;
  /// P(a change) since the last that was accepted.
  [[nodiscard]] double probability_changed() const;
  /// Posterior probabilities of the parameter draws, with and without a change together.
  [[nodiscard]] Eigen::VectorXd draw_probabilities() const;
  /// Takes the most probable candidate's shift into the intercepts and begins anew without
  /// candidates.
  void accept_change();

  /// p x c (covariates of the series): ∂ feature/∂ covariate at the last row's weather, once the
  /// lag has passed; mean of the draws, zero for a covariate that is left out.
  [[nodiscard]] Eigen::MatrixXd covariate_slopes(int covariates) const;

  [[nodiscard]] std::int64_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<CandidateOnset>& candidates() const { return candidates_; }
  /// Sum over all merges of the posterior mass that moved to a neighbouring onset.
  [[nodiscard]] double moved_mass() const { return moved_; }

 private:
  struct RowScores;  // scores of the candidates in one row
  void bear_candidates(const Row& row, double hours);
  Eigen::VectorXd score_healthy(const Row& row, double hours, const std::vector<Weather>& weather,
                                PredictedRow& out);
  double weigh_draws(const Eigen::VectorXd& own, const Eigen::VectorXd& shared);
  void score_draw(std::size_t m, const Row& row, const Weather& weather, RowScores& scores);
  void weigh_candidates(const RowScores& scores, double log_healthy);
  void merge_old();
  bool merge_one(std::vector<CandidateOnset>& list, ShiftProfile profile);
  void merge(std::vector<CandidateOnset>& list, std::size_t from, std::size_t into);
  [[nodiscard]] CandidateOnset born(const Row& row, ShiftProfile profile) const;
  double weigh_healthy(const RowScores& scores, double log_baseline);
  void retire_transients(double hours);
  [[nodiscard]] std::vector<CandidateOnset*> all_candidates();

  CovariateScaling scaling_;
  Eigen::VectorXd residual_sd_;
  ChangePointOptions options_;
  std::vector<BaselineDraw> draws_;      ///< without a change
  std::vector<BaselineFilter> changed_;  ///< filters that candidates share, one per draw
  Eigen::VectorXd log_weight_;           ///< weights of the draws, without a change
  Eigen::VectorXd shared_;  ///< part of each draw's weight that belongs to the candidates' filter
  std::vector<CandidateOnset> candidates_, transients_;
  double log_quiet_ = 0.0;  ///< ln P(no transient | no change)
  double last_hours_ = 0.0, last_ramp_hours_ = 0.0;
  double log_no_change_ = 0.0;  ///< ln of the prior probability of no change so far
  double moved_ = 0.0;
  std::int64_t rows_ = 0;

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, ChangePoint>
  friend void carry(Parcel& parcel, Of& c) {
    parcel(c.scaling_, c.residual_sd_, c.options_, c.draws_, c.changed_, c.log_weight_, c.shared_,
           c.candidates_, c.transients_, c.log_quiet_, c.last_hours_, c.last_ramp_hours_,
           c.log_no_change_, c.moved_, c.rows_);
  }
};

}  // namespace wheeltap::identification::monitoring
