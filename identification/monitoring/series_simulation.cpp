#include "identification/monitoring/series_simulation.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;

/// Parts of a simulation, each with a separate stream of random numbers.
enum class SimulatedPart : std::uint64_t {
  weather,
  thermometers,
  drift,
  unmeasured,
  noise,
  missing
};

base::Random stream_of(std::uint64_t seed, SimulatedPart part) {
  return {seed, static_cast<std::uint64_t>(part), 0, base::Purpose::simulation};
}

/// A stationary Ornstein-Uhlenbeck process of unit variance.
class UnitProcess {
 public:
  UnitProcess(double hours, double interval) : kept_(std::exp(-interval / hours)) {}
  double next(base::Random& random) {
    const double z = random.normal();
    value_ = started_ ? kept_ * value_ + std::sqrt(1.0 - kept_ * kept_) * z : z;
    started_ = true;
    return value_;
  }

 private:
  double kept_, value_ = 0.0;
  bool started_ = false;
};

double air_without_fronts(const WeatherTruth& w, double hours) {
  const double day = w.first_day + hours / 24.0;
  return w.mean - w.season * std::cos(kTwoPi * (day - 15.0) / 365.25) -
         w.day * std::cos(kTwoPi * (day - 4.0 / 24.0));
}

double student_over_sd(base::Random& random, double degrees) {
  const double z = random.normal();
  if (degrees <= 0.0) return z;
  const double scale = random.gamma(0.5 * degrees) / (0.5 * degrees);
  // Scaled to unit variance if the variance is finite.
  return z / std::sqrt(scale) * (degrees > 2.0 ? std::sqrt((degrees - 2.0) / degrees) : 1.0);
}

double share_of_change(const ChangeTruth& change, double hours) {
  if (hours < change.hours) return 0.0;
  return change.ramp_hours > 0.0 ? std::min(1.0, (hours - change.hours) / change.ramp_hours) : 1.0;
}

}  // namespace

Series simulate_series(const SeriesTruth& truth, std::uint64_t seed) {
  const auto n = static_cast<Index>(truth.rows);
  const auto p = static_cast<Index>(truth.features.size());
  const auto c = static_cast<Index>(truth.thermometers.size());
  base::Random weather = stream_of(seed, SimulatedPart::weather),
               thermometers = stream_of(seed, SimulatedPart::thermometers),
               drifting = stream_of(seed, SimulatedPart::drift),
               unmeasured = stream_of(seed, SimulatedPart::unmeasured),
               noise = stream_of(seed, SimulatedPart::noise),
               missing = stream_of(seed, SimulatedPart::missing);
  const double step = truth.interval_hours;
  UnitProcess front(truth.weather.front_hours, step), common(truth.drift_hours, step),
      other(truth.unmeasured_hours, step);
  std::vector<UnitProcess> own(truth.features.size(), UnitProcess(truth.drift_hours, step));
  const double shared = std::sqrt(truth.drift_correlation),
               alone = std::sqrt(1.0 - truth.drift_correlation);
  Series out{.features = Eigen::MatrixXd(n, p), .covariates = Eigen::MatrixXd(n, c)};
  double structure = 0.0;
  std::vector<double> lagged(truth.thermometers.size());
  const auto follow = [&](double& value, double air, double lag, bool first) {
    value = first || lag <= 0.0 ? air : air + (value - air) * std::exp(-step / lag);
  };
  for (Index t = 0; t < n; ++t) {
    const double hours = step * static_cast<double>(t);
    const bool first = t == 0;
    out.hours.push_back(hours);
    const double air =
        air_without_fronts(truth.weather, hours) + truth.weather.front_sd * front.next(weather);
    follow(structure, air, truth.lag_hours, first);
    for (Index i = 0; i < c; ++i) {
      const ThermometerTruth& one = truth.thermometers[index(i)];
      follow(lagged[index(i)], air, one.lag_hours, first);
      out.covariates(t, i) = lagged[index(i)] + one.noise_sd * thermometers.normal();
    }
    const double cold = std::min(0.0, structure - truth.freezing);
    const double frost = truth.gradual_frost ? -0.1 * cold * cold : cold;
    const double together = common.next(drifting), everywhere = other.next(unmeasured);
    for (Index j = 0; j < p; ++j) {
      const FeatureTruth& f = truth.features[index(j)];
      const double drift = shared * together + alone * own[index(j)].next(drifting);
      const bool outlier = noise.uniform() < truth.outlier_share;
      const double e = f.noise_sd * (outlier ? truth.outlier_factor : 1.0) *
                       student_over_sd(noise, truth.noise_degrees);
      out.features(t, j) = std::log(f.value) + f.slope * (structure - truth.weather.mean) +
                           f.frost * frost + f.drift_sd * drift + f.unmeasured_sd * everywhere + e;
      if (missing.uniform() < truth.missing_share) out.features(t, j) = kNaN;
    }
    for (const ChangeTruth& change : truth.changes) {
      const double share = share_of_change(change, hours);
      if (change.shift.size() > 0) out.features.row(t) += share * change.shift.transpose();
      if (change.offset.size() > 0) out.covariates.row(t) += share * change.offset.transpose();
    }
  }
  return out;
}

}  // namespace wheeltap::identification::monitoring
