#include "identification/monitoring/monitor.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::monitoring {
namespace {

bool can_train(const Series& series) {
  return std::ranges::all_of(find_faults(series, series.rows()), [](const SeriesFault& fault) {
    return fault.kind == SeriesFault::Kind::covariate_constant;
  });
}

void append(const Eigen::MatrixXd& rows, Eigen::MatrixXd& to) {
  if (rows.size() == 0) return;
  to.conservativeResize(to.rows() + rows.rows(), rows.cols());
  to.bottomRows(rows.rows()) = rows;
}

/// Residuals of the last third of the learning rows, by a baseline of the first two thirds. If the
/// last third is shorter than a block of replay, or the first two cannot train a baseline:
/// residuals of each quarter of the rows, by a baseline of the other quarters, in shorter blocks.
Replay replay_of(const Series& learning, const Baseline& all, const MonitorOptions& options) {
  ReplayOptions replayed = options.replay;
  if (replayed.rows == 0)
    replayed.rows = std::clamp(learning.rows(), kFewestReplayRows, kMostReplayRows);
  const int n = learning.rows(), trained = 2 * n / 3;
  const Series first = learning.first(trained);
  if (n - trained >= replayed.block && can_train(first)) {
    const Baseline part = refit_baseline(first, all, options.learning);
    return replay(part, healthy_innovations(part, learning, trained, n), options.change, replayed);
  }
  constexpr int kFolds = 4;
  replayed.block = std::clamp(n / 8, 1, replayed.block);
  Innovations innovations;
  for (int fold = 0; fold < kFolds; ++fold) {
    const int from = fold * n / kFolds, to = (fold + 1) * n / kFolds;
    Series others = learning;
    others.features.middleRows(from, to - from).setConstant(kNaN);
    // Too few rows for a baseline of the others: by that of all rows.
    const Baseline part = can_train(others) ? refit_baseline(others, all, options.learning) : all;
    const Innovations more = healthy_innovations(part, learning, from, to);
    append(more.standardised, innovations.standardised);
    append(more.relative_variance, innovations.relative_variance);
  }
  return replay(all, innovations, options.change, replayed);
}

std::vector<RowFinding> learning_findings(const Series& learning, const Baseline& baseline) {
  BaselineDraw draw = baseline.draws.front();
  const Eigen::VectorXd learned = draw.filter.x;
  draw.filter = BaselineFilter(draw.parameters);
  draw.lagged.resize(0);
  draw.lagged_error.resize(0);
  draw.slow.resize(0);
  const Eigen::Index block = draw.parameters.block();
  std::vector<RowFinding> out;
  for (int t = 0; t < learning.rows(); ++t) {
    const Row row = row_of(learning, t, baseline.usual_sds);
    const double step = t > 0 ? row.hours - learning.hours[index(t - 1)] : 0.0;
    const Weather weather = next_weather(baseline.scaling(row.covariates), step, draw);
    const RowPrediction predicted = filter_row(draw.parameters, weather, row, step, draw.filter);
    RowFinding one{.hours = row.hours,
                   .predicted = {.mean = predicted.mean,
                                 .sd = predicted.sd,
                                 .weather = Eigen::VectorXd(learning.feature_count())}};
    for (Eigen::Index j = 0; j < learning.feature_count(); ++j)
      one.predicted.weather[j] =
          learned.segment(j * block + 1, block - 3).dot(weather.h.segment(1, block - 3));
    one.corrected = row.features - one.predicted.weather;
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

Monitor::Monitor(const Series& learning, const MonitorOptions& options)
    : is_calibrated_(options.is_calibrated), settling_rows_(options.settling_rows) {
  LearningOptions baseline = options.learning;
  if (options.progress)
    baseline.progress = [&](double fraction) { return options.progress("learning", fraction); };
  baseline_ = learn_baseline(learning, baseline);
  if (options.progress) options.progress("replay", 0.0);
  replay_ = replay_of(learning, baseline_, options);
  log_stated_ = std::log(options.mean_rows_between_false_alarms.value_or(
      rows_per_year() / options.false_alarms_per_year));
  change_ = ChangePoint(baseline_, options.change);
  learned_ = learning_findings(learning, baseline_);
  for (BaselineDraw& draw : baseline_.draws) draw.filter = {};  // change_ has copies
}

Monitor Monitor::with_rate(double false_alarms_per_year, bool is_calibrated) const {
  Monitor out = *this;
  out.log_stated_ = std::log(rows_per_year() / false_alarms_per_year);
  out.is_calibrated_ = is_calibrated;
  return out;
}

double Monitor::log_threshold_replayed() const {
  return replay_.log_threshold(std::exp(-log_stated_));
}

double Monitor::probability_changed() const {
  const double changed = std::min(change_.probability_changed(), 1.0 - 1e-15);
  return std::max(0.0, -std::expm1(log_unchanged_ + std::log1p(-changed)));  // no -0
}

RowFinding Monitor::add(const Row& row) {
  RowFinding out{.hours = row.hours};
  out.predicted = change_.add(row);
  out.corrected = row.features - out.predicted.weather;
  const bool is_scored = out.predicted.is_scored;
  if (!is_scored && row.features.array().isFinite().any()) ++unscored_rows_;
  out.log_statistic = change_.log_statistic();
  out.probability_changed = probability_changed();
  if (is_scored && settling_left_ == 0 && out.log_statistic >= log_threshold()) {
    out.alarm = true;
    alarms_.push_back({.hours = row.hours, .probability_at_alarm = change_.probability_changed()});
    settling_left_ = settling_rows_ + 1;
  }
  if (is_scored && settling_left_ > 0) {
    AlarmRecord& last = alarms_.back();
    last.change = change_.estimate();
    last.likelihood = shift_likelihood(change_.candidates(), row.hours, baseline_.residual_sd);
    // The mean over the rows since the alarm: slopes differ between frost and mild weather.
    const double rows = settling_rows_ + 2 - settling_left_;
    const Eigen::MatrixXd slopes =
        change_.covariate_slopes(static_cast<int>(row.covariates.size()));
    if (last.covariate_slopes.size() == 0) last.covariate_slopes = slopes;
    last.covariate_slopes += (slopes - last.covariate_slopes) / rows;
    if (--settling_left_ == 0) {
      log_unchanged_ += std::log1p(-std::min(alarms_.back().change.probability, 1.0 - 1e-15));
      change_.accept_change();
    }
  }
  return out;
}

}  // namespace wheeltap::identification::monitoring
