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

/// The part of a record to score, and the interpolation of its excitations.
struct RecordUse {
  /// Stated sampling rate; must agree with a time column
  std::optional<double> sample_rate_hz = {};
  std::optional<std::pair<int, int>> samples = {};  ///< first scored sample, one past the last
  int lead_in = 0;                                  ///< number of samples before the window
  /// True: the excitations had no content above half the sampling rate and are upsampled by sinc
  /// interpolation. False: they are linear between their samples.
  bool band_limited = false;
  bool resample = false;  ///< interpolate non-uniform time steps to a uniform rate
  /// Upsampling factor; empty: chosen so that linear interpolation loses at most 0.3 %
  std::optional<int> upsample = {};
};

/// Puts a record's rate, window and signals into the case, and compares the spectrum of each
/// channel's window with that of the whole record. Throws InvalidInput (channel, sample_rate,
/// samples, lead_in); throws io::FileError for numbers that are missing in the window or
/// non-uniform times.
void take_record(SidCase& sid_case, const signals::Record& record, const RecordUse& use);

/// Reports implausible data: windows whose spectra differ from the record's, excitations that are
/// not linear between their samples, and units without a conversion.
[[nodiscard]] std::vector<Remark> record_remarks(const SidCase& sid_case);

/// The amount of motion of the responses at the start of the window. The result is empty if the
/// responses start at rest, or if the record does not determine whether they do. For displacements
/// and velocities, the amount is the value of the first samples divided by the RMS, if it exceeds a
/// tenth and three standard errors. For accelerations, the amount comes from the first quarter of a
/// period, and only if the window starts later than the record.
[[nodiscard]] std::optional<double> moves_at_start(const SidCase& sid_case);

/// Makes the initial state of the model unknown, with normal priors about 0. The scale of a mass's
/// prior is the standard deviation of its displacement. If only velocity or acceleration is
/// measured, the scale is the sd of the velocity over ω, or the sd of the acceleration over ω²,
/// where ω is the RMS frequency of the spectrum. A mass without a sensor gets the largest scale of
/// the other masses. Throws InvalidInput (initial) if the responses are constant.
void infer_initial(SidCase& sid_case, SidModel& model);

}  // namespace wheeltap::identification
