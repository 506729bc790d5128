// Conversion of a record's columns to the signals of a case: window, sampling rate and
// interpolation.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::identification {

/// The samples of a record that the likelihood uses (the scored samples), and the interpolation of
/// its excitations.
struct RecordUse {
  /// Stated sampling rate; must agree with a time column
  std::optional<double> sample_rate_hz = {};
  std::optional<std::pair<int, int>> samples = {};  ///< first scored sample, one past the last
  int lead_in = 0;                                  ///< number of samples before the window
  /// True: the excitations have no content above half the sampling rate and are upsampled by sinc
  /// interpolation. False: excitations are linear between samples.
  bool band_limited = false;
  bool resample = false;  ///< true: interpolate samples to uniform time steps
  /// Upsampling factor; empty: smallest power of two with an amplitude loss of at most 0.3 %
  std::optional<int> upsample = {};
};

/// Writes a record's sampling rate, window and signals into the case, and compares the spectrum of
/// each channel's window with that of the whole record. Throws InvalidInput (channel, sample_rate,
/// samples, lead_in); throws io::FileError for missing numbers in the window and for non-uniform
/// times.
void take_record(SidCase& sid_case, const signals::Record& record, const RecordUse& use);

/// Reports implausible data: windows whose spectra differ from those of the record, excitations
/// that are not linear between samples, and units that Wheeltap cannot convert.
[[nodiscard]] std::vector<Remark> record_remarks(const SidCase& sid_case);

/// The response at the start of the window divided by its RMS: the largest ratio of all responses.
/// Empty if the responses start at rest, or if the record is inconclusive. Only ratios above a
/// tenth are used. For a displacement or velocity, the value at the start must also exceed three
/// standard errors. For an acceleration, the ratio is the RMS of the first quarter of a period
/// divided by the total RMS. The ratio of an acceleration is used only if the window starts after
/// the start of the record and has no lead-in.
[[nodiscard]] std::optional<double> moves_at_start(const SidCase& sid_case);

/// Makes the initial state of the model unknown, with normal priors about 0. For each mass, the
/// scale of the prior is the sd of its measured displacement. If only the velocity is measured, the
/// scale is its sd divided by ω; if only the acceleration is measured, the scale is its sd divided
/// by ω². Here, ω is the RMS frequency of the spectrum. A mass without a sensor gets the largest
/// scale of the other masses. Throws InvalidInput (initial) if the responses are constant.
void infer_initial(SidCase& sid_case, SidModel& model);

}  // namespace wheeltap::identification
