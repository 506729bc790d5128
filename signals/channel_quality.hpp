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

  /// Dropouts: runs of an identical value that are longer than chance explains. With p the share of
  /// equal neighbours, a dropout has a length of which less than a thousandth is expected in a
  /// record of this size, and at least five samples.
  std::vector<Stretch> dropouts = {};
  /// Clipped samples: those at the highest and the lowest value where at least three follow each
  /// other.
  long clipped_high = 0, clipped_low = 0;
  /// Spikes: single samples that differ from the cubic through two neighbours on either side by
  /// more than 12 local robust standard deviations of that difference. Replacing the sample by the
  /// cubic must make the surroundings ordinary. The difference is a linear filter of the record, so
  /// it is Gaussian if the record is, however narrow its band. None if more than a thousandth of
  /// all samples qualify: then they belong to the signal.
  std::vector<long> spikes = {};
  /// Trend: rise of the fitted line over the whole record, in standard deviations of the residual.
  double drift = 0.0;
  /// Drift: standard deviation of the means of twenty blocks over that of all samples, without the
  /// trend; near 0 for a stationary record, near 1 for a drifting one.
  double wander = 0.0;
};

/// Checks a channel. `x` may hold NaN; these samples are counted and excluded.
[[nodiscard]] ChannelQuality channel_quality(std::span<const double> x);

/// Fault of a channel. The comments state FoundFault::value and, in brackets, its bound.
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

/// Lists the faults in the order above. A constant channel can only have missing samples besides; a
/// counter has no other fault. Without `is_record`, the channel is not a vibration record, and only
/// missing samples are checked.
[[nodiscard]] std::vector<FoundFault> channel_faults(const ChannelQuality& quality, bool is_record);

/// A local maximum of a spectrum.
struct SpectrumPeak {
  double frequency_hz;   ///< from a parabola through three lines of the logarithm
  double density;        ///< [unit² / Hz]
  double prominence_db;  ///< height above the higher of the two valleys that separate it from
                         ///< higher peaks
};

/// The `most` most prominent peaks, sorted by frequency. Peaks of less than `least_db` are scatter.
[[nodiscard]] std::vector<SpectrumPeak> spectrum_peaks(const Spectrum& spectrum, int most,
                                                       double least_db = 10.0);

}  // namespace wheeltap::signals
