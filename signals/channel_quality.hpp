// What is wrong with a measured channel, before anybody fits a model to it.
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
  long missing = 0;  ///< not finite
  double mean = 0.0, sd = 0.0, lowest = 0.0, highest = 0.0;
  double rms = 0.0;   ///< about zero
  double step = 0.0;  ///< smallest difference between two values that occur: the resolution
  bool constant = false;

  /// Runs of one and the same value, longer than chance makes them: with p the share of equal
  /// neighbours, runs of which less than a thousandth is expected in a record of this length, and
  /// of five samples at least.
  std::vector<Stretch> dropouts = {};
  /// Samples on the highest and the lowest value, where three or more follow each other there.
  long clipped_high = 0, clipped_low = 0;
  /// Single samples that differ from the cubic through two neighbours on either side by more than
  /// 12 robust standard deviations of that difference in their surroundings, while the record about
  /// them is ordinary once they are replaced by it. The difference is a linear filter of the
  /// record, so that it is Gaussian where the record is, however narrow its band. None where more
  /// than a thousandth of all samples do: that is the signal.
  std::vector<long> spikes = {};
  /// Rise of the fitted line over the whole record, in standard deviations of what is left.
  double drift = 0.0;
  /// Standard deviation of the means of twenty blocks over that of all, without the line: near 0
  /// for a stationary record, near 1 for one that wanders.
  double wander = 0.0;
};

/// `x` may hold NaN; those samples are counted and left out.
[[nodiscard]] ChannelQuality channel_quality(std::span<const double> x);

/// What is wrong with a channel. In brackets: value, and the bound that it passes.
enum class ChannelFault {
  missing,   ///< samples (0)
  constant,  ///< the value that it has
  dropouts,  ///< samples in all of them (0)
  clipped,   ///< samples at either end (0)
  spikes,    ///< how many (0)
  counter,   ///< rises evenly, without scatter
  drift,     ///< over the record, in standard deviations (±1)
  wander,    ///< as ChannelQuality has it (0.3), where there is no drift
  offset,    ///< |mean|, in standard deviations (3)
  coarse     ///< resolution, in standard deviations (0.05)
};

struct FoundFault {
  ChannelFault fault;
  double value, bound = 0.0;
};

/// In the order above. A constant channel has no faults but missing samples beside that, a counter
/// none; of a channel that is no record of a vibration, missing samples alone are judged.
[[nodiscard]] std::vector<FoundFault> channel_faults(const ChannelQuality& quality, bool is_record);

/// A local maximum of a spectrum.
struct SpectrumPeak {
  double frequency_hz;   ///< of the parabola through three lines of the logarithm
  double density;        ///< [unit² / Hz]
  double prominence_db;  ///< above the higher of the valleys that part it from higher ground
};

/// The most prominent, `most` of them, by frequency; those of less than `least_db` are scatter.
[[nodiscard]] std::vector<SpectrumPeak> spectrum_peaks(const Spectrum& spectrum, int most,
                                                       double least_db = 10.0);

}  // namespace wheeltap::signals
