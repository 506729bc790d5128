// The onset of a shift of features, inferred with one filter per candidate onset.
//
//   y_tj = baseline_tj + r(t - τ) δ_j,   t >= τ
//
//   step: r = 1;   ramp: r = min(1, (t - τ)/kRampHours);   transient: r = exp(-(t -
//   τ)/kTransientHours)
//
// A transient is a temporary effect of thaw, wind, traffic or wrong modal identification. A
// transient does not count as a change. The model without a change is a mixture: the baseline, and
// transients that began at any row. A change must explain the data better than this mixture. At
// each row, probability moves from the transients to the baseline: the probability of each decayed
// transient, and the probability that a transient has ended early.
//
// A shift acts linearly. After a shift, the innovations of a filter that assumes no shift are v_t +
// G_t δ; a recursion common to all values of δ gives G_t (Friedland 1969; Willsky & Jones 1976).
// For each candidate, candidate_bank.hpp stores the sensitivity F of the state to δ and the
// posterior of δ, which is exact for Gaussian noise. The prior of δ has two equally probable
// components: a shift of all features, and a shift of exactly one feature. In the second component,
// all features are equally probable. In both components,
//
//   δ_j ~ N(0, (s r_j)²), s: one of kShiftSizes (equally probable), r_j: residual sd of feature j.
//
// For Student t noise, predictive densities are normalised as in baseline_filter.hpp. All
// candidates share one noise inflation per entry: the mean over the candidates, weighted by
// posterior mass. The filter without a change has a separate noise inflation, because only this
// filter treats entries after damage as outliers.
//
// The weights of the parameter draws have a fixed-share update (Herbster & Warmuth 1998). At each
// row, the fraction `fixed_share` of all weights is redistributed evenly, so that every draw keeps
// some weight. Every predictive density is normalised, hence Λ_τ,t is a test martingale under the
// mixture without a change.
#pragma once

#include <cstdint>
#include <optional>

#include "identification/monitoring/baseline_learning.hpp"
#include "identification/monitoring/candidate_bank.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kShiftSizes[kSizes] = {0.5, 1.5, 5.0};
inline constexpr double kRampHours = 30.0 * 24.0;
inline constexpr double kTransientHours = 72.0;

enum class ShiftProfile { step, ramp, transient };

struct ChangePointOptions {
  double hazard_per_hour = 1e-5;               ///< prior rate of changes per hour
  double transients_per_hour = 12.0 / 8766.0;  ///< prior rate of transients; 0: none
  /// Rate at which transients end suddenly instead of decaying.
  double transient_ends_per_hour = 1.0 / kTransientHours;
  double ramp_share = 0.25;  ///< prior probability that a change is a ramp; 0: only steps
  int ramp_every = 24;       ///< rows between two candidate ramps
  /// All candidates that began less than this number of rows ago are kept. Of the older candidates,
  /// `kept_per_octave` are kept per doubling of the age. For ramps, four times this number of rows
  /// and two candidates per doubling apply. 0: all candidates are kept.
  int young = 16;
  int kept_per_octave = 5;
  double fixed_share = 0.01;  ///< fraction of the draws' weight that each row redistributes
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ChangePointOptions>
void carry(Parcel& parcel, Of& o) {
  parcel(o.hazard_per_hour, o.transients_per_hour, o.transient_ends_per_hour, o.ramp_share,
         o.ramp_every, o.young, o.kept_per_octave, o.fixed_share);
}

struct CandidateOnset {
  std::int64_t row = 0;  ///< first row with the shift, counted from the start of monitoring
  double hours = 0.0;    ///< time of row `row`
  double first_hours = 0.0, last_hours = 0.0;  ///< times of the earliest and latest merged onset
  /// Mean and variance of the times of the merged onsets, weighted by the posterior masses of the
  /// onsets
  double mean_hours = 0.0, variance_hours = 0.0;
  ShiftProfile profile = ShiftProfile::step;
  double log_ratio = 0.0;   ///< ln Λ
  double log_wealth = 0.0;  ///< ln of the onset's term in the Shiryaev-Roberts sum
  /// ln of the onset's prior probability, including merged candidates. For a transient, log_mass()
  /// is ln of the transient's probability within the model without a change.
  double log_prior = 0.0;
  int slot = -1;  ///< slot in the bank of shifts
  /// Posterior of δ for each parameter draw; only in the result of ChangePoint::candidates().
  std::vector<ShiftPosterior> draws = {};
  [[nodiscard]] double log_mass() const { return log_prior + log_ratio; }
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, CandidateOnset>
void carry(Parcel& parcel, Of& c) {
  parcel(c.row, c.hours, c.first_hours, c.last_hours, c.mean_hours, c.variance_hours, c.profile,
         c.log_ratio, c.log_wealth, c.log_prior, c.slot);
}

/// Prediction of a row if no change occurred since the last alarm.
struct PredictedRow {
  Eigen::VectorXd mean, sd;  ///< mean and sd of the p features' logarithms, over the draws
  Eigen::VectorXd weather;   ///< posterior mean effect of the covariates (p entries)
  /// False if the row has no features, or if the effect of the weather is unknown because
  /// covariates are missing (ChangePoint::add).
  bool is_scored = true;
};

/// Share of the shift δ that is reached a time `hours` after the onset.
[[nodiscard]] double profile_at(ShiftProfile profile, double hours);

/// Estimate of a change since a given time.
struct ChangeEstimate {
  double probability = 0.0;                                      ///< P(change)
  double onset_low = 0.0, onset_median = 0.0, onset_high = 0.0;  ///< hours; 2.5, 50 and 97.5 %
  double ramp_probability = 0.0;                                 ///< P(ramp | change)
  /// Shifts of the p features' logarithms at the last row, given a change.
  Eigen::VectorXd shift, shift_sd;
  Eigen::VectorXd shifted_probability;  ///< probability that each feature shifted, given a change
};

class ChangePoint {
 public:
  ChangePoint() = default;
  ChangePoint(const Baseline& baseline, const ChangePointOptions& options);

  /// Processes the next row; all its features may be missing. The features of a row are not used if
  /// the error from missing covariates may shift a feature by more than kLargestWeatherError times
  /// its residual standard deviation. An error from missing covariates is common to many rows and
  /// would resemble a change of the structure.
  PredictedRow add(const Row& row);

  /// ln of the Shiryaev-Roberts statistic: the sum over the terms of all candidates.
  [[nodiscard]] double log_statistic() const;
  [[nodiscard]] ChangeEstimate estimate() const;
  /// Probability of a change since the last accepted change.
  [[nodiscard]] double probability_changed() const;
  /// Posterior probabilities of the parameter draws, summed over the models with and without a
  /// change.
  [[nodiscard]] Eigen::VectorXd draw_probabilities() const;
  /// Adds the current shift to the intercepts, and removes all candidates. The new state has the
  /// mean and the covariance of a mixture over "no change" and all hypotheses of all candidates.
  void accept_change();

  /// p x c (covariates of the series): steady-state slopes ∂ feature/∂ covariate at the covariates
  /// of the last row; mean over the draws, zero for an unused covariate.
  [[nodiscard]] Eigen::MatrixXd covariate_slopes(int covariates) const;

  [[nodiscard]] std::int64_t rows() const { return rows_; }
  /// All candidate onsets with their posteriors of δ.
  [[nodiscard]] std::vector<CandidateOnset> candidates() const;
  /// Total posterior probability that merges have moved to a neighbouring onset.
  [[nodiscard]] double moved_mass() const { return moved_; }

 private:
  [[nodiscard]] bool knows_weather() const;
  void bear_candidates(const Row& row, double hours);
  Eigen::VectorXd score_healthy(const Row& row, double hours, const std::vector<Weather>& weather,
                                PredictedRow& out);
  double weigh_draws(const Eigen::VectorXd& own, const Eigen::VectorXd& shared);
  double score_draw(std::size_t m, const Row& row, const Weather& weather,
                    const CandidateBank::RowStart& start);
  void weigh_candidates(const std::vector<double>& log_density, double log_healthy);
  void merge_old();
  bool merge_one(std::vector<CandidateOnset>& list, ShiftProfile profile);
  void merge(std::vector<CandidateOnset>& list, std::size_t from, std::size_t into);
  [[nodiscard]] CandidateOnset born(const Row& row, ShiftProfile profile);
  double weigh_healthy(const std::vector<double>& log_density, double log_baseline);
  void retire_transients(double hours);

  CovariateScaling scaling_;
  Eigen::VectorXd residual_sd_;
  ChangePointOptions options_;
  LastCovariates last_covariates_;
  std::vector<BaselineDraw> draws_;      ///< filters that assume no change
  std::vector<BaselineFilter> changed_;  ///< filters that all candidates share, one per draw
  Eigen::VectorXd log_weight_;           ///< log weights of the draws in the model without a change
  Eigen::VectorXd shared_;  ///< part of each draw's weight that belongs to the candidates' filter
  std::vector<CandidateOnset> candidates_, transients_;
  CandidateBank bank_;      ///< posteriors of the candidates' shifts
  double log_quiet_ = 0.0;  ///< ln P(no transient | no change)
  double rows_per_hour_ = 1.0;
  double last_hours_ = 0.0, last_ramp_hours_ = 0.0, last_scored_hours_ = 0.0;
  double log_no_change_ = 0.0;  ///< ln of the prior probability of no change so far
  double moved_ = 0.0;
  std::int64_t rows_ = 0, last_ramp_row_ = -1;

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, ChangePoint>
  friend void carry(Parcel& parcel, Of& c) {
    parcel(c.scaling_, c.last_covariates_, c.residual_sd_, c.options_, c.draws_, c.changed_,
           c.log_weight_, c.shared_, c.candidates_, c.transients_, c.bank_, c.log_quiet_,
           c.rows_per_hour_, c.last_hours_, c.last_ramp_hours_, c.last_scored_hours_,
           c.log_no_change_, c.moved_, c.rows_, c.last_ramp_row_);
  }
};

}  // namespace wheeltap::identification::monitoring
