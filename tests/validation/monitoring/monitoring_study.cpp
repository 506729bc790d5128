// Simulated years under weather: false alarms of healthy years, and delays of damaged years, of
// the detector at several stated rates and of the control charts.
//
//   monitoring_study KIND FIRST LAST [HOURS]   one line of JSON for each year in [FIRST, LAST)
//
// KIND: modelled, gradual (frost acts gradually), heavy (Student t noise with 3 degrees of freedom
// and 5 % outliers), unmeasured (a covariate that nobody measures), summer (training from May to
// October, without frost). HOURS: interval of the rows.
//
// A series has a year of training, and a monitored year, healthy and then again with a damage: from
// a random instant on, the features are lower by about a tenth of the range that the weather gives
// them (damage_of). The detector is trained once for all stated rates. years_table.py makes tables
// of the lines.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>

#include <nlohmann/json.hpp>

#include "base/index.hpp"
#include "base/random.hpp"
#include "identification/monitoring/charts/comparison_charts.hpp"
#include "identification/monitoring/monitor.hpp"
#include "identification/monitoring/series_simulation.hpp"

namespace {

using namespace wheeltap;
using namespace wheeltap::identification::monitoring;
using Json = nlohmann::ordered_json;

constexpr int kFeatures = 6;
constexpr int kFactors = 120;
/// Factors of the charts' thresholds: 0.2 to about 24.
double factor_of(int i) {
  return 0.2 * std::pow(1.041, i);
}

SeriesTruth truth_of(const std::string& kind, double interval) {
  SeriesTruth out{.rows = static_cast<int>(2.0 * kHoursPerYear / interval),
                  .interval_hours = interval,
                  .thermometers = {ThermometerTruth{}},
                  .lag_hours = 5.0,
                  .outlier_share = 0.01,
                  .missing_share = 0.3};
  constexpr double values[kFeatures] = {3.98, 5.17, 9.9, 10.3, 12.6, 17.2};
  for (int j = 0; j < kFeatures; ++j) {
    const double slope = -0.0004 - 0.0001 * (j % 3);
    out.features.push_back({.value = values[j],
                            .slope = slope,
                            .frost = 4.0 * slope,
                            .noise_sd = 0.002,
                            .unmeasured_sd = kind == "unmeasured" ? 0.002 : 0.0});
  }
  out.gradual_frost = kind == "gradual";
  if (kind == "summer") {
    out.weather.first_day = 120.0;
    out.rows = static_cast<int>(1.5 * kHoursPerYear / interval);
  }
  if (kind == "heavy") {
    out.noise_degrees = 3.0;
    out.outlier_share = 0.05;
  }
  return out;
}

/// From a random instant of the monitored year on, each feature is lower by a tenth of the range
/// that the weather of the series gives it, times a random factor between 0 and 2.
ChangeTruth damage_of(const SeriesTruth& truth, const Series& healthy, base::Random& random) {
  const double years = truth.rows * truth.interval_hours / kHoursPerYear;
  const double coldest = healthy.covariates.minCoeff(), warmest = healthy.covariates.maxCoeff();
  ChangeTruth out{.hours = (years - 1.0 + 0.9 * random.uniform()) * kHoursPerYear,
                  .shift = Eigen::VectorXd(kFeatures),
                  .offset = Eigen::VectorXd::Zero(1)};
  for (int j = 0; j < kFeatures; ++j) {
    const FeatureTruth& of = truth.features[index(j)];
    const double range =
        of.slope * (warmest - coldest) + of.frost * std::max(0.0, truth.freezing - coldest);
    out.shift[j] = 0.1 * range * 2.0 * random.uniform();
  }
  return out;
}

struct Variant {
  std::string name;
  double rate;
  bool is_calibrated;
};

const std::vector<Variant> kVariants = {{"replay 0.1", 0.1, true}, {"replay 1", 1.0, true},
                                        {"replay 10", 10.0, true}, {"model 0.1", 0.1, false},
                                        {"model 1", 1.0, false},   {"model 10", 10.0, false}};

struct Alarms {
  std::vector<double> healthy = {}, damaged = {};
};

/// Alarms in both versions of the monitored year, which are equal until `onset`.
Alarms alarms_of(Monitor monitor, const Series& healthy, const Series& damaged, int trained,
                 double onset) {
  Alarms out;
  const auto monitor_rows = [](Monitor& m, const Series& series, int from, double until,
                               std::vector<double>& alarms) {
    int t = from;
    for (; t < series.rows() && series.hours[index(t)] < until; ++t)
      if (m.add(row_of(series, t, m.baseline().usual_sds)).alarm)
        alarms.push_back(series.hours[index(t)]);
    return t;
  };
  const int changed = monitor_rows(monitor, healthy, trained, onset, out.healthy);
  out.damaged = out.healthy;
  Monitor other = monitor;
  monitor_rows(monitor, healthy, changed, INFINITY, out.healthy);
  monitor_rows(other, damaged, changed, INFINITY, out.damaged);
  return out;
}

/// For every factor of a chart's threshold: alarms in the healthy year, and hours from the damage
/// to the first row above the threshold (-1: none).
Json charts_of(const Series& healthy, const Series& damaged, int trained, double onset) {
  const auto rows = static_cast<double>(healthy.rows() - trained);
  const std::vector<ChartFinding> before = run_charts(healthy, trained, rows, 1);
  const std::vector<ChartFinding> after = run_charts(damaged, trained, rows, 1);
  Json out = Json::object();
  for (std::size_t i = 0; i < before.size(); ++i) {
    std::vector<int> alarms;
    std::vector<double> delays;
    for (int f = 0; f < kFactors; ++f) {
      const double threshold = factor_of(f) * before[i].threshold;
      alarms.push_back(static_cast<int>(chart_alarms(before[i].statistic, threshold).size()));
      double delay = -1.0;
      for (std::size_t t = 0; t < after[i].statistic.size() && delay < 0.0; ++t) {
        const double hours = damaged.hours[index(trained) + t];
        if (hours >= onset && after[i].statistic[t] >= threshold) delay = hours - onset;
      }
      delays.push_back(delay);
    }
    out[before[i].name] = {{"alarms", alarms}, {"delays", delays}};
  }
  return out;
}

Json year_of(const std::string& kind, int year, double interval) {
  const std::clock_t start = std::clock();
  SeriesTruth truth = truth_of(kind, interval);
  const auto seed = static_cast<std::uint64_t>(1000 + year);
  const Series healthy = simulate_series(truth, seed);
  base::Random random(seed, 0, 0, base::Purpose::test);
  truth.changes = {damage_of(truth, healthy, random)};
  const Series damaged = simulate_series(truth, seed);
  const double onset = truth.changes[0].hours;
  const int trained = healthy.rows() - static_cast<int>(kHoursPerYear / interval);

  MonitorOptions options{.false_alarms_per_year = 1.0};
  options.learning.seed = options.replay.seed = seed;
  const Monitor monitor(healthy.first(trained), options);
  const std::clock_t learned = std::clock();

  std::vector<Variant> variants = kVariants;
  std::ranges::sort(variants, {}, [&](const Variant& v) {
    return monitor.with_rate(v.rate, v.is_calibrated).log_threshold();
  });
  Json quiet = Json::object(), alarmed = Json::object();
  Json replayed = Json::object(), raised = Json::object();
  Alarms alarms;
  double threshold = -INFINITY;  // of `alarms`; without alarms, a higher one raises none either
  for (const Variant& v : variants) {
    const Monitor m = monitor.with_rate(v.rate, v.is_calibrated);
    const bool is_quiet =
        std::isfinite(threshold) && alarms.healthy.empty() && alarms.damaged.empty();
    if (m.log_threshold() > threshold && !is_quiet)
      alarms = alarms_of(m, healthy, damaged, trained, onset);
    threshold = m.log_threshold();
    quiet[v.name] = alarms.healthy;
    alarmed[v.name] = alarms.damaged;
    replayed[v.name] = m.replay().rate(m.log_threshold_stated()) * m.rows_per_year();
    raised[v.name] = m.log_threshold() > m.log_threshold_stated();
  }
  const std::clock_t monitored = std::clock();

  Json out{{"kind", kind},         {"year", year},
           {"interval", interval}, {"hours", healthy.hours.back() - healthy.hours[index(trained)]},
           {"onset", onset},       {"healthy", quiet},
           {"damaged", alarmed},   {"replayed", replayed},
           {"raised", raised},     {"charts", charts_of(healthy, damaged, trained, onset)}};
  const auto seconds = [](std::clock_t from, std::clock_t to) {
    return static_cast<double>(to - from) / CLOCKS_PER_SEC;
  };
  out["seconds"] = {{"training", seconds(start, learned)},
                    {"monitoring", seconds(learned, monitored)},
                    {"charts", seconds(monitored, std::clock())}};
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "monitoring_study KIND FIRST LAST [HOURS]\n";
    return 64;
  }
  const std::vector<std::string> kinds = {"modelled", "gradual", "heavy", "unmeasured", "summer"};
  if (std::ranges::find(kinds, argv[1]) == kinds.end()) {
    std::cerr << argv[1] << " is no kind of year\n";
    return 64;
  }
  for (int year = std::atoi(argv[2]); year < std::atoi(argv[3]); ++year)
    std::cout << year_of(argv[1], year, argc > 4 ? std::atof(argv[4]) : 1.0).dump() << std::endl;
  return 0;
}
