#include "identification/monitoring/alarm.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Baseline with the drift and noise of the first draw about a known level.
Baseline without_covariates(const Baseline& of) {
  const BaselineParameters& from = of.draws.front().parameters;
  BaselineDraw draw{.parameters = from};
  draw.parameters.terms = {};
  draw.parameters.coefficient_mean = MatrixXd::Zero(1, from.features());
  draw.parameters.coefficient_sd = 1e-3 * from.noise_sd.transpose();
  draw.filter = BaselineFilter(draw.parameters);
  return {.residual_sd = of.residual_sd, .draws = {draw}, .rows_per_hour = of.rows_per_hour};
}

double largest_statistic(const Baseline& baseline, const Innovations& innovations,
                         const ChangePointOptions& change, const ReplayOptions& options,
                         int number) {
  base::Random random(options.seed, index(number), 0, base::Purpose::simulation);
  ChangePoint detector(baseline, change);
  const BaselineParameters& b = baseline.draws.front().parameters;
  BaselineFilter simulated = baseline.draws.front().filter;
  const double step = 1.0 / baseline.rows_per_hour;
  const auto p = static_cast<Index>(b.features());
  const Weather weather{.h = VectorXd::Ones(3)};
  double largest = -kInfinity;
  Index at = 0;
  const MatrixXd& healthy = innovations.standardised;
  VectorXd covariance;
  for (int t = 0; t < options.rows; ++t) {
    at = t % options.block == 0 ? random.index(static_cast<int>(healthy.rows()))
                                : (at + 1) % healthy.rows();
    Row row{.hours = (t + 1) * step,
            .features = VectorXd::Constant(p, kNaN),
            .relative_variance = VectorXd::Ones(p),
            .covariates = VectorXd()};
    if (innovations.relative_variance.size() > 0)
      row.relative_variance = innovations.relative_variance.row(at).transpose();
    simulated.predict(b, step);
    for (Index j = 0; j < p; ++j) {
      const double z = healthy(at, j);
      if (!std::isfinite(z)) continue;
      const int feature = static_cast<int>(j);
      simulated.observe(feature, weather.h, covariance);
      const double noise = noise_variance(b, weather, row, simulated, feature);
      const double s = simulated.variance(feature, weather.h, covariance) + noise;
      const double v = z * std::sqrt(s);
      row.features[j] = simulated.mean(feature, weather.h) + v;
      simulated.update(covariance, v, s + noise * (noise_inflation(v, s, b.degrees) - 1.0));
    }
    detector.add(row);
    largest = std::max(largest, detector.log_statistic());
  }
  return largest;
}

}  // namespace

double Replay::rate(double log_threshold) const {
  double p = 0.5 * std::exp(-(log_threshold - log_median) / tail);
  if (log_threshold < log_median) {
    p = 0.5;
    if (!log_maxima.empty()) {
      // P at the i-th smallest of n maxima, with half a maximum above all of them.
      const auto n = static_cast<double>(series);
      const auto place = std::ranges::upper_bound(log_maxima, log_threshold);
      const auto i = static_cast<double>(place - log_maxima.begin());
      p = 1.0 - (i + 0.5) / n;
      if (place != log_maxima.begin()) {
        const double low = *(place - 1), high = place == log_maxima.end() ? log_median : *place;
        const double next = place == log_maxima.end() ? 0.5 : 1.0 - (i + 0.5) / n;
        const double here = 1.0 - (i - 0.5) / n;
        p = high > low ? here + (next - here) * (log_threshold - low) / (high - low) : next;
      }
    }
  }
  return -std::log1p(-p) / rows;
}

bool Replay::is_lower_bound(double log_threshold) const {
  return log_threshold < (log_maxima.empty() ? log_median : log_maxima.front());
}

double Replay::log_threshold(double rate) const {
  const double p = -std::expm1(-rate * rows);
  if (p < 0.5) return log_median - tail * std::log(2.0 * p);
  // Bisection: the rate decreases between the smallest maximum and the median.
  double low = log_maxima.empty() ? log_median : log_maxima.front(), high = log_median;
  for (int i = 0; i < 60 && high > low; ++i) {
    const double middle = 0.5 * (low + high);
    (this->rate(middle) > rate ? low : high) = middle;
  }
  return high;
}

Innovations healthy_innovations(const Baseline& baseline, const Series& series, int from, int to) {
  BaselineDraw draw = baseline.draws.front();
  draw.filter.reset_drift(draw.parameters);
  draw.lagged.resize(0);
  draw.lagged_error.resize(0);
  draw.slow.resize(0);
  const Index p = series.feature_count();
  std::vector<VectorXd> standardised, variances;
  std::vector<char> is_known;
  double before = series.hours.front();
  LastCovariates last;
  for (int t = 0; t < to; ++t) {
    const Row row = row_of(series, t, baseline.usual_sds);
    const double step = row.hours - before;
    before = row.hours;
    const Weather weather = next_weather(baseline.scaling(row.covariates, last), step, draw);
    if (t < from) continue;
    is_known.push_back(is_weather_known(draw, baseline.residual_sd) ? 1 : 0);
    variances.push_back(row.relative_variance);
    standardised.push_back(
        filter_row(draw.parameters, weather, row, step, draw.filter).standardised);
  }
  // ChangePoint::add does not use rows of unknown weather. If they are most of the rows, they are
  // kept: their larger innovations raise the threshold.
  const auto known = std::ranges::count(is_known, 1);
  const bool is_all = 2 * known < to - from;
  const auto n = static_cast<Index>(is_all ? to - from : known);
  Innovations out{.standardised = MatrixXd(n, p)};
  if (baseline.usual_sds.size() > 0) out.relative_variance.resize(n, p);
  Index at = 0;
  for (std::size_t t = 0; t < is_known.size(); ++t) {
    if (!is_all && is_known[t] == 0) continue;
    out.standardised.row(at) = standardised[t].transpose();
    if (out.relative_variance.size() > 0) out.relative_variance.row(at) = variances[t].transpose();
    ++at;
  }
  return out;
}

Replay replay(const Baseline& baseline, const Innovations& innovations,
              const ChangePointOptions& change, const ReplayOptions& options) {
  const Baseline reduced = without_covariates(baseline);
  std::vector<double> largest(index(options.series));
  base::parallel_for(options.series, options.threads, [&](int i) {
    largest[index(i)] = largest_statistic(reduced, innovations, change, options, i);
  });
  std::ranges::sort(largest);
  Replay out{.series = options.series, .rows = options.rows};
  const std::size_t middle = largest.size() / 2;
  out.log_median = largest[middle];
  out.log_maxima.assign(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(middle));
  double sum = 0.0;
  for (std::size_t i = middle; i < largest.size(); ++i) sum += largest[i] - out.log_median;
  out.tail = std::max(1.0, sum / static_cast<double>(largest.size() - middle));
  return out;
}

}  // namespace wheeltap::identification::monitoring
