// The alarm statistic S_t, a sum of likelihood ratios Λ over onsets τ, and its threshold.
//
//   S_t = Σ_{τ<=t} Λ_τ,t   (Shiryaev-Roberts; Shin, Ramdas & Rinaldo 2024, e-detectors)
//
// Under a correct baseline model, the mean of S_t is at most t (in rows), so that the mean number
// of rows to a false alarm at threshold A is at least A. Because the baseline model may be wrong,
// the threshold is also calibrated by replay: the detector processes series of standardised
// residuals. Blocks of residuals are drawn from healthy rows outside the training rows.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/monitoring/change_point.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr int kFewestReplayRows = 240, kMostReplayRows = 1440;

struct ReplayOptions {
  int series = 48;  ///< number of replayed series, each with a new detector
  /// Rows per series. If 0, a Monitor uses the number of training rows, limited to the range from
  /// kFewestReplayRows to kMostReplayRows.
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
/// = 1/2 exp(-(ln A - u)/h). h is the mean excess, but at least 1. The reason for this lower limit:
/// under the model, the false-alarm probability in n rows is at most n/A, and this bound decays
/// with h = 1. Below the median, P(A) is the fraction of maxima above ln A, interpolated between
/// the maxima. If all maxima are above ln A, each series has an alarm and the rate is a lower
/// bound.
struct Replay {
  int series = 0, rows = 0;
  double log_median = 0.0;              ///< u
  double tail = 1.0;                    ///< h
  std::vector<double> log_maxima = {};  ///< maxima below the median, sorted
  /// False alarms per row at a threshold.
  [[nodiscard]] double rate(double log_threshold) const;
  /// True if the rate at this threshold is a lower bound.
  [[nodiscard]] bool is_lower_bound(double log_threshold) const;
  /// ln of the threshold at which false alarms have this rate; at least the smallest of the series'
  /// maxima of ln S.
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
  /// Noise variance of each entry, divided by the usual noise variance of the feature. Empty (all
  /// ratios are 1) if the series states no standard deviations.
  Eigen::MatrixXd relative_variance = {};
};

/// Innovations in rows [from, to) of the series, from the filter of the first draw with its trained
/// coefficients. The drift begins with its stationary distribution, and lagged covariates follow
/// from the rows before `from`. The rows may therefore be anywhere in the training period. Rows
/// whose weather is unknown (is_weather_known) are omitted, unless the weather of more than half of
/// all rows is unknown.
[[nodiscard]] Innovations healthy_innovations(const Baseline& baseline, const Series& series,
                                              int from, int to);

/// Processes `innovations` and their noise variances with a detector that has the drift and noise
/// of the first draw and no covariates.
[[nodiscard]] Replay replay(const Baseline& baseline, const Innovations& innovations,
                            const ChangePointOptions& change, const ReplayOptions& options);

}  // namespace wheeltap::identification::monitoring
