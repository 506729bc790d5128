// The alarm statistic S_t, a sum of likelihood ratios Λ over onsets τ, and its threshold.
//
//   S_t = Σ_{τ<=t} Λ_τ,t   (Shiryaev-Roberts; Shin, Ramdas & Rinaldo 2024, e-detectors)
//
// Under the baseline, the mean of S_t is at most t (in rows), so that the mean number of rows to a
// false alarm at threshold A is at least A. This holds only if the baseline model is correct. The
// threshold is therefore also calibrated by replay: the detector processes series of standardised
// residuals, drawn in blocks from healthy rows that did not train the baseline.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/monitoring/change_point.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr int kFewestReplayRows = 240, kMostReplayRows = 1440;

struct ReplayOptions {
  int series = 48;  ///< number of replayed series; each starts a new detector
  /// Rows per series. 0 in a Monitor: the number of training rows, but between kFewestReplayRows
  /// and kMostReplayRows.
  int rows = 0;
  int block = 72;  ///< rows per block of residuals
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Rate of false alarms in replayed healthy series, as a function of the threshold A:
///
///   rate(A) = -ln(1 - P(A))/rows,   P(A) = P(the maximum of ln S in a series exceeds ln A).
///
/// Above the median u of the series' maxima, the excesses are assumed exponential with mean h: P(A)
/// = 1/2 exp(-(ln A - u)/h). h is the mean excess, but at least 1: under the model, the bound n/A
/// of the false-alarm probability in n rows decays with h = 1. Below the median, P(A) is the share
/// of maxima above ln A, interpolated between the maxima. If all maxima are above ln A, the rate is
/// a lower bound: each series has at least one alarm.
struct Replay {
  int series = 0, rows = 0;
  double log_median = 0.0;              ///< u
  double tail = 1.0;                    ///< h
  std::vector<double> log_maxima = {};  ///< below the median, sorted
  /// False alarms per row at a threshold.
  [[nodiscard]] double rate(double log_threshold) const;
  /// True if the rate at this threshold is a lower bound.
  [[nodiscard]] bool is_lower_bound(double log_threshold) const;
  /// ln of the threshold with this rate of false alarms; at least the smallest maximum.
  [[nodiscard]] double log_threshold(double rate) const;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Replay>
void carry(Parcel& parcel, Of& r) {
  parcel(r.series, r.rows, r.log_median, r.tail, r.log_maxima);
}

/// One-step innovations of healthy rows, n x p.
struct Innovations {
  Eigen::MatrixXd standardised = {};  ///< innovations divided by their scales; NaN: missing
  /// Noise variance of each entry relative to the usual variance of the feature. If empty, the
  /// series states no standard deviations, and the ratio is 1.
  Eigen::MatrixXd relative_variance = {};
};

/// Innovations of the first draw's filter in rows [from, to) of the series. The coefficients are
/// those of the trained filter. The drift begins with its stationary distribution, and lagged
/// covariates follow from the rows before `from`, so that the rows may be anywhere in the training
/// period. Rows whose weather is unknown (is_weather_known) are left out, unless they are more
/// than half.
[[nodiscard]] Innovations healthy_innovations(const Baseline& baseline, const Series& series,
                                              int from, int to);

/// Processes `innovations` and their noise variances with a detector that has the drift and noise
/// of the first draw and no covariates.
[[nodiscard]] Replay replay(const Baseline& baseline, const Innovations& innovations,
                            const ChangePointOptions& change, const ReplayOptions& options);

}  // namespace wheeltap::identification::monitoring
