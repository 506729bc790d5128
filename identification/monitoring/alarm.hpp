// When to raise an alarm.
//
//   S_t = Σ_{τ<=t} Λ_τ,t   (Shiryaev-Roberts; Shin, Ramdas & Rinaldo 2024, e-detectors)
//
// has a mean of at most t rows under the baseline, so that the mean number of rows to a false alarm
// at threshold A is at least A. That holds under the model only. The threshold is therefore also
// calibrated by replay: standardised residuals of healthy rows that did not train the baseline are
// drawn in blocks and run through the detector as new series.
#pragma once

#include <cstdint>

#include "identification/monitoring/change_point.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr int kFewestReplayRows = 240, kMostReplayRows = 1440;

struct ReplayOptions {
  int series = 48;  ///< replayed, each from the start
  /// Rows of one; 0 in a Monitor: as many as it learns from, kFewestReplayRows to kMostReplayRows.
  int rows = 0;
  int block = 72;  ///< rows drawn together
  std::uint64_t seed = 1;
  int threads = 1;
};

/// False alarms of replayed healthy series, as a function of the threshold. Exceedances of the
/// series' maxima of ln S over their median u are taken as exponential with mean h:
///
///   rate(A) = -ln(1 - P(A))/rows,   P(A) = 1/2 exp(-(ln A - u)/h).
///
/// h is the mean of the exceedances, and at least 1: the model's own bound n/A decays no faster.
struct Replay {
  int series = 0, rows = 0;
  double log_median = 0.0;  ///< u
  double tail = 1.0;        ///< h
  /// False alarms a row at a threshold.
  [[nodiscard]] double rate(double log_threshold) const;
  /// ln of the threshold with this rate; not below u.
  [[nodiscard]] double log_threshold(double rate) const;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Replay>
void carry(Parcel& parcel, Of& r) {
  parcel(r.series, r.rows, r.log_median, r.tail);
}

/// Healthy rows as the filter predicted them, n x p.
struct Innovations {
  Eigen::MatrixXd standardised = {};  ///< over their scales; NaN: missing
  /// Noise variance of each entry relative to a usual one; empty: 1, no sd is stated.
  Eigen::MatrixXd relative_variance = {};
};

/// Innovations of the first draw's filter.
[[nodiscard]] Innovations healthy_innovations(const Baseline& baseline, const Series& rows);

/// Replays `innovations`, with their noise variances, through a detector with the first draw's
/// drift and noise, and no covariates.
[[nodiscard]] Replay replay(const Baseline& baseline, const Innovations& innovations,
                            const ChangePointOptions& change, const ReplayOptions& options);

}  // namespace wheeltap::identification::monitoring
