// Quality checks of a measured channel before any model is fitted.
#pragma once

#include <span>
#include <vector>

#include "signals/spectra.hpp"

namespace wheeltap::signals {

/// Samples [begin, end).
struct Stretch {
  long begin, end;
};

struct ChannelQuality {
  long samples = 0;
  long missing = 0;  ///< number of samples that are not finite
  double mean = 0.0, sd = 0.0, lowest = 0.0, highest = 0.0;
  double rms = 0.0;   ///< root mean square about zero
  double step = 0.0;  ///< resolution: the smallest difference between two values that occur
  bool constant = false;

  /// Dropouts: runs of an identical value that are too long to occur by chance. A dropout has at
  /// least five samples. With p the share of equal neighbouring samples, fewer than 0.001 runs of
  /// its length are expected in a record of this size.
  std::vector<Stretch> dropouts = {};
  /// Clipped samples: those at the highest and at the lowest value, in runs of at least three.
  long clipped_high = 0, clipped_low = 0;
  /// Spikes: single samples that differ from the cubic through two neighbours on either side by
  /// more than 12 local robust standard deviations of that difference. After the sample is replaced
  /// by the cubic, the differences around it must be below this limit. The difference is a linear
  /// filter of the record, so it is Gaussian if the record is, whatever its bandwidth. If more than
  /// a thousandth of all samples satisfy the criterion, they belong to the signal and the list is
  /// empty.
  std::vector<long> spikes = {};
  /// Trend: rise of the fitted line over the whole record, in standard deviations of the residual.
  double drift = 0.0;
  /// Drift: ratio of the standard deviation of the means of twenty blocks to that of all samples,
  /// both without the trend; near 0 for a stationary record, near 1 for a drifting one.
  double wander = 0.0;
};

/// Checks a channel. `x` may contain NaN; such samples are counted as missing and excluded.
[[nodiscard]] ChannelQuality channel_quality(std::span<const double> x);

/// Fault of a channel. The comment of each fault states the meaning of FoundFault::value and, in
/// brackets, its limit.
enum class ChannelFault {
  missing,   ///< missing samples (0)
  constant,  ///< the constant value
  dropouts,  ///< samples in all dropouts (0)
  clipped,   ///< samples at either end (0)
  spikes,    ///< number of spikes (0)
  counter,   ///< ChannelQuality::drift, infinite: rises evenly, without scatter
  drift,     ///< ChannelQuality::drift (±1)
  wander,    ///< ChannelQuality::wander (0.3), without drift
  offset,    ///< |mean|, in standard deviations (3)
  coarse     ///< resolution, in standard deviations (0.05)
};

struct FoundFault {
  ChannelFault fault;
  double value, bound = 0.0;
};

/// Lists the faults in the order above. A constant channel has no further fault except missing
/// samples, and a counter has no further fault at all. If `is_record` is false, the channel is not
/// a vibration record, and only missing samples are checked.
[[nodiscard]] std::vector<FoundFault> channel_faults(const ChannelQuality& quality, bool is_record);

/// A local maximum of a spectrum.
struct SpectrumPeak {
  double frequency_hz;   ///< from a parabola through three lines of the logarithm
  double density;        ///< [unit² / Hz]
  double prominence_db;  ///< height above the higher of the two valleys that separate it from
                         ///< higher peaks
};

/// The `most` most prominent peaks, sorted by frequency. Peaks with a prominence below `least_db`
/// are omitted as scatter.
[[nodiscard]] std::vector<SpectrumPeak> spectrum_peaks(const Spectrum& spectrum, int most,
                                                       double least_db = 10.0);

}  // namespace wheeltap::signals
