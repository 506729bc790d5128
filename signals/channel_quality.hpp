// Quality checks of a measured channel before any model is fitted.
#pragma once

#include <span>
#include <vector>

#include "signals/spectra.hpp"

namespace wheeltap::signals {

/// An interval of a record: samples [begin, end).
struct Stretch {
  long begin, end;
};

struct ChannelQuality {
  long samples = 0;
  long missing = 0;  ///< number of samples that are not finite
  double mean = 0.0, sd = 0.0, lowest = 0.0, highest = 0.0;
  double rms = 0.0;   ///< root mean square about zero
  double step = 0.0;  ///< resolution: smallest nonzero difference between two samples
  bool constant = false;

  /// Dropouts: sequences of equal samples that are too long to occur by chance. A dropout has at
  /// least five samples. The expected number of equally long sequences that occur in the record by
  /// chance is below 0.001. The expected number follows from the fraction p of pairs of
  /// neighbouring samples that are equal.
  std::vector<Stretch> dropouts = {};
  /// Number of clipped samples at the highest value and at the lowest value of the channel. Only
  /// sequences of at least three clipped samples count.
  long clipped_high = 0, clipped_low = 0;
  /// Spikes: single samples that differ from the cubic polynomial through two neighbours on either
  /// side. The difference must exceed 12 times its local robust standard deviation. After the
  /// sample is replaced by the value of the polynomial, the differences of the neighbouring samples
  /// must be below this limit. The difference is the output of a linear filter, and is therefore
  /// Gaussian for a Gaussian record of any bandwidth. If more than a thousandth of all samples
  /// satisfy the criterion, these samples belong to the signal and the list is empty.
  std::vector<long> spikes = {};
  /// Trend: rise of the fitted line over the whole record, divided by the standard deviation of the
  /// samples about this line.
  double drift = 0.0;
  /// Drift: the standard deviation of the means of twenty blocks, divided by the standard deviation
  /// of all samples. Both standard deviations are computed after removal of the trend. The ratio is
  /// near 0 for a stationary record and near 1 for a drifting record.
  double wander = 0.0;
};

/// Checks the quality of a channel with the samples `x`. Samples that are NaN are counted as
/// missing and excluded from the checks.
[[nodiscard]] ChannelQuality channel_quality(std::span<const double> x);

/// Fault of a channel. The comment of each fault states the meaning of FoundFault::value and, in
/// brackets, its limit.
enum class ChannelFault {
  missing,   ///< number of missing samples (0)
  constant,  ///< the constant value
  dropouts,  ///< number of samples in all dropouts (0)
  clipped,   ///< number of clipped samples (0)
  spikes,    ///< number of spikes (0)
  counter,   ///< ChannelQuality::drift is infinite: the samples increase by equal steps
  drift,     ///< ChannelQuality::drift, the trend (±1)
  wander,    ///< ChannelQuality::wander (0.3), only if the drift is within its limit
  offset,    ///< |mean| / standard deviation of the samples (3)
  coarse     ///< resolution / standard deviation of the samples (0.05)
};

struct FoundFault {
  ChannelFault fault;
  double value, bound = 0.0;
};

/// Lists the faults of a channel in the order of ChannelFault. For a constant channel, the list
/// contains no other faults than `constant` and `missing`; for a counter, it contains only
/// `counter`. If `is_record` is false, the channel is not a vibration record, and this function
/// checks only for missing samples.
[[nodiscard]] std::vector<FoundFault> channel_faults(const ChannelQuality& quality, bool is_record);

/// A local maximum of a spectrum.
struct SpectrumPeak {
  double frequency_hz;   ///< from a parabola through the logarithm of the density at three spectral
                         ///< lines
  double density;        ///< [unit² / Hz]
  double prominence_db;  ///< height above the higher of the two minima that separate the peak from
                         ///< higher peaks
};

/// Finds the `most` most prominent peaks of a spectrum, sorted by frequency. Peaks with a
/// prominence below `least_db` are omitted, because random errors of the estimated spectrum can
/// cause such peaks.
[[nodiscard]] std::vector<SpectrumPeak> spectrum_peaks(const Spectrum& spectrum, int most,
                                                       double least_db = 10.0);

}  // namespace wheeltap::signals
