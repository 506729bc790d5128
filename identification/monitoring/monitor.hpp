// Monitoring: trains a baseline, then processes rows one by one.
#pragma once

#include <functional>
#include <optional>

#include "identification/monitoring/alarm.hpp"
#include "identification/monitoring/shift_likelihood.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kHoursPerYear = 8766.0;

struct MonitorOptions {
  double false_alarms_per_year = 0.1;
  /// If set, this mean number of rows between false alarms replaces the rate of false alarms per
  /// year.
  std::optional<double> mean_rows_between_false_alarms = {};
  ChangePointOptions change = {};
  LearningOptions learning = {};
  ReplayOptions replay = {};
  /// False: the threshold is computed from the model; the replay only gives the false-alarm rate of
  /// this threshold.
  bool is_calibrated = true;
  /// Number of rows after an alarm that refine the estimate of the change. After these rows, the
  /// monitor accepts the change and resets the detector.
  int settling_rows = 24;
  /// Called with the stage and its completed fraction; returns false to stop the training.
  std::function<bool(const char* stage, double fraction)> progress = nullptr;
};

struct AlarmRecord {
  double hours = 0.0;
  double probability_at_alarm = 0.0;
  ChangeEstimate change = {};  ///< estimate that uses `settling_rows` rows after the alarm
  // Quantities from the same rows that explain the change (change_explanation.hpp):
  ShiftLikelihood likelihood = {};
  Eigen::MatrixXd covariate_slopes = {};  ///< p x c
};

/// Results of one row.
struct RowFinding {
  double hours = 0.0;
  PredictedRow predicted = {};
  Eigen::VectorXd corrected = {};  ///< logarithms of the p features minus the covariates' effect
  double log_statistic = 0.0;
  double probability_changed = 0.0;  ///< probability of at least one change since the start
  bool alarm = false;
};

class Monitor {
 public:
  Monitor() = default;
  /// Trains the baseline on `learning`, whose rows all belong to the healthy structure. Throws the
  /// exceptions of learn_baseline.
  Monitor(const Series& learning, const MonitorOptions& options);

  RowFinding add(const Row& row);

  /// A copy with the trained state, for another stated rate of false alarms, without new training.
  [[nodiscard]] Monitor with_rate(double false_alarms_per_year, bool is_calibrated) const;

  /// One-step predictions of the training rows, without the alarm statistic. The filter uses the
  /// first draw of the parameters. Empty for a deserialised monitor.
  [[nodiscard]] const std::vector<RowFinding>& learned() const { return learned_; }
  [[nodiscard]] const Baseline& baseline() const { return baseline_; }
  [[nodiscard]] const ChangePoint& change() const { return change_; }
  [[nodiscard]] const std::vector<AlarmRecord>& alarms() const { return alarms_; }
  [[nodiscard]] double probability_changed() const;
  [[nodiscard]] const Replay& replay() const { return replay_; }
  /// ln of the threshold that the model gives for the stated rate of false alarms.
  [[nodiscard]] double log_threshold_stated() const { return log_stated_; }
  /// ln of the threshold that the replay gives for this rate.
  [[nodiscard]] double log_threshold_replayed() const;
  /// ln of the threshold in use: with calibration the larger threshold, otherwise the model's.
  [[nodiscard]] double log_threshold() const {
    return is_calibrated_ ? std::max(log_stated_, log_threshold_replayed()) : log_stated_;
  }
  [[nodiscard]] double rows_per_year() const { return baseline_.rows_per_hour * kHoursPerYear; }

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, Monitor>
  friend void carry(Parcel& parcel, Of& m) {
    parcel(m.baseline_, m.change_, m.replay_, m.alarms_, m.log_stated_, m.is_calibrated_,
           m.settling_left_, m.settling_rows_, m.unscored_rows_, m.log_unchanged_);
  }

  /// Number of monitored rows whose features were not used, because covariates of these rows
  /// were missing.
  [[nodiscard]] int unscored_rows() const { return unscored_rows_; }

 private:
  int unscored_rows_ = 0;
  Baseline baseline_;
  ChangePoint change_;
  Replay replay_;
  std::vector<AlarmRecord> alarms_;
  std::vector<RowFinding> learned_;
  double log_stated_ = 0.0;
  bool is_calibrated_ = true;
  int settling_left_ = 0, settling_rows_ = 24;
  double log_unchanged_ = 0.0;  ///< ln P(no change before the last accepted change)
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ChangeEstimate>
void carry(Parcel& parcel, Of& c) {
  parcel(c.probability, c.onset_low, c.onset_median, c.onset_high, c.ramp_probability, c.shift,
         c.shift_sd, c.shifted_probability);
}

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, AlarmRecord>
void carry(Parcel& parcel, Of& a) {
  parcel(a.hours, a.probability_at_alarm, a.change, a.likelihood, a.covariate_slopes);
}

}  // namespace wheeltap::identification::monitoring
