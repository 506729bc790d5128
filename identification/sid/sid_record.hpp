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
  std::optional<double> sample_rate_hz = {};        ///< as stated; must agree with a time column
  std::optional<std::pair<int, int>> samples = {};  ///< scored: first, one past the last
  int lead_in = 0;                                  ///< samples before the window
  /// True: the excitations had no content above half the sampling rate and are upsampled by a sinc.
  /// False: they are linear between their samples.
  bool band_limited = false;
  bool resample = false;  ///< interpolate a record with uneven time steps at an even rate
  std::optional<int> upsample = {};  ///< factor; empty: linear interpolation may lose 0.3 %
};

/// Puts a record's rate, window and signals into the case, and compares the spectrum of each
/// channel's window with that of the whole record. Throws InvalidInput (channel, sample_rate,
/// samples, lead_in); throws io::FileError for numbers that are missing in the window or times that
/// are uneven.
void take_record(SidCase& sid_case, const signals::Record& record, const RecordUse& use);

/// Reports implausible data: windows with other spectra than the record, excitations that are not
/// linear between their samples, and units without a conversion.
[[nodiscard]] std::vector<Remark> record_remarks(const SidCase& sid_case);

/// The amount of motion of the responses at the start of the window; empty if they start at rest or
/// if the record cannot show this. Displacements and velocities: first samples relative to the RMS,
/// if above a tenth and three standard errors. Accelerations: the first quarter of a period, only
/// if the window starts within the record.
[[nodiscard]] std::optional<double> moves_at_start(const SidCase& sid_case);

/// Makes the model's initial state unknown, with normal priors about 0. The scale of a prior is the
/// sd of the mass's displacement, or of its velocity divided by ω or acceleration divided by ω²,
/// where ω is the RMS frequency of the spectrum. A mass without a sensor gets the largest scale of
/// the other masses. Throws InvalidInput (initial) if the responses are constant.
void infer_initial(SidCase& sid_case, SidModel& model);

}  // namespace wheeltap::identification
