// Simulated series: features of a structure under weather, with changes at stated times.
//
//   air(t) = mean - season cos(2π (day - 15)/365.25) - day cos(2π (hour - 4)/24) + front(t)
//   v'     = (air - v)/lag                                      (temperature of the structure)
//   ln y_j = ln f_j + a_j (v - mean) + k_j c(min(0, v - freezing)) + w_j + d_j + e_j + changes_j
//
// c(x) = x, or -x²/10 if frost acts gradually. front, d_j (drift) and w (an unmeasured covariate,
// common to all features) are Ornstein-Uhlenbeck processes; e_j is normal or Student t noise. Some
// entries are outliers, whose noise is several times larger; others are missing. Each covariate is
// a thermometer that measures `air` with a separate lag and noise.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

struct WeatherTruth {
  double mean = 10.0, season = 10.0, day = 4.0;  ///< °C: mean; amplitudes of annual and daily cycle
  double front_sd = 3.0, front_hours = 60.0;     ///< sd [°C] and time constant [h] of front(t)
  double first_day = 0.0;                        ///< day of the year at time zero
};

struct FeatureTruth {
  double value = 1.0;       ///< value of the feature at the mean temperature
  double slope = -0.0005;   ///< slope of the feature's logarithm against temperature, 1/K
  double frost = -0.0025;   ///< the additional slope below freezing, 1/K
  double noise_sd = 0.003;  ///< noise: sd divided by the value
  double drift_sd = 0.001, unmeasured_sd = 0.0;
};

struct ThermometerTruth {
  double lag_hours = 0.0, noise_sd = 0.1;
};

/// A change of features or of thermometer readings, as a step or a ramp.
struct ChangeTruth {
  double hours = 0.0, ramp_hours = 0.0;
  Eigen::VectorXd shift = {};   ///< shifts of the p features' logarithms
  Eigen::VectorXd offset = {};  ///< c, K
};

struct SeriesTruth {
  int rows = 8766;
  double interval_hours = 1.0;
  WeatherTruth weather = {};
  std::vector<FeatureTruth> features = {};
  std::vector<ThermometerTruth> thermometers = {};
  double lag_hours = 0.0, freezing = 0.0;
  bool gradual_frost = false;
  double drift_hours = 72.0;
  double drift_correlation = 0.5;  ///< correlation of the drifts of any two features, in [0, 1)
  double unmeasured_hours = 48.0;
  double noise_degrees = 0.0;  ///< degrees of freedom of Student t noise; 0: normal noise
  double outlier_share = 0.0, outlier_factor = 10.0, missing_share = 0.0;
  std::vector<ChangeTruth> changes = {};
};

/// Simulates a series; its names are empty. Weather, drift, noise and the choice of missing entries
/// use separate random streams, so that a changed setting of one does not change the others.
[[nodiscard]] Series simulate_series(const SeriesTruth& truth, std::uint64_t seed);

}  // namespace wheeltap::identification::monitoring
