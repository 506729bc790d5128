#include "identification/monitoring/monitor.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace wheeltap::identification::monitoring {
namespace {

Series rows_from(const Series& series, int from) {
  Series out = series;
  const auto left = static_cast<Eigen::Index>(series.rows() - from);
  out.hours.assign(series.hours.begin() + from, series.hours.end());
  out.features = series.features.bottomRows(left);
  if (series.sds.size() > 0) out.sds = series.sds.bottomRows(left);
  out.covariates = series.covariates.bottomRows(left);
  return out;
}

/// Residuals of the last third of the learning rows, by a baseline of the first two thirds. Where
/// the last third is shorter than a block of replay, or the first two cannot be learned from: of
/// all rows, in shorter blocks.
Replay replay_of(const Series& learning, const Baseline& all, const MonitorOptions& options) {
  ReplayOptions replayed = options.replay;
  if (replayed.rows == 0)
    replayed.rows = std::clamp(learning.rows(), kFewestReplayRows, kMostReplayRows);
  const int trained = 2 * learning.rows() / 3;
  const Series first = learning.first(trained);
  bool is_short = learning.rows() - trained < replayed.block;
  for (const SeriesFault& fault : find_faults(first, trained))
    is_short = is_short || fault.kind != SeriesFault::Kind::covariate_constant;
  if (is_short) {
    replayed.block = std::clamp(learning.rows() / 8, 1, replayed.block);
    Baseline start{.scaling = all.scaling,
                   .usual_sds = all.usual_sds,
                   .draws = all.draws,
                   .last_hours = learning.hours.front()};
    return replay(all, healthy_innovations(start, learning), options.change, replayed);
  }
  const Baseline part = refit_baseline(first, all, options.learning);
  return replay(part, healthy_innovations(part, rows_from(learning, trained)), options.change,
                replayed);
}

std::vector<RowFinding> learning_findings(const Series& learning, const Baseline& baseline) {
  BaselineDraw draw = baseline.draws.front();
  const Eigen::VectorXd learned = draw.filter.x;
  draw.filter = BaselineFilter(draw.parameters);
  draw.lagged.resize(0);
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
    : settling_rows_(options.settling_rows) {
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
  for (BaselineDraw& draw : baseline_.draws) draw.filter = {};  // lives on in change_
}

double Monitor::log_threshold_replayed() const {
  return replay_.log_threshold(std::exp(-log_stated_));
}

double Monitor::probability_changed() const {
  return -std::expm1(log_unchanged_ +
                     std::log1p(-std::min(change_.probability_changed(), 1.0 - 1e-15)));
}

RowFinding Monitor::add(const Row& row) {
  RowFinding out{.hours = row.hours};
  out.predicted = change_.add(row);
  out.corrected = row.features - out.predicted.weather;
  out.log_statistic = change_.log_statistic();
  out.probability_changed = probability_changed();
  if (settling_left_ == 0 && out.log_statistic >= log_threshold()) {
    out.alarm = true;
    alarms_.push_back({.hours = row.hours, .probability_at_alarm = change_.probability_changed()});
    settling_left_ = settling_rows_ + 1;
  }
  if (settling_left_ > 0) {
    AlarmRecord& last = alarms_.back();
    last.change = change_.estimate();
    last.likelihood = shift_likelihood(change_.candidates(), baseline_.residual_sd);
    last.covariate_slopes = change_.covariate_slopes(static_cast<int>(row.covariates.size()));
    if (--settling_left_ == 0) {
      log_unchanged_ += std::log1p(-std::min(alarms_.back().change.probability, 1.0 - 1e-15));
      change_.accept_change();
    }
  }
  return out;
}

}  // namespace wheeltap::identification::monitoring
