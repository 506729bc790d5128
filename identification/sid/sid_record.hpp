// From the columns of a record to the signals of a case: its window, its rate, and what stands
// between its samples.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::identification {

/// Which part of a record to score, and how its excitations are to be taken.
struct RecordUse {
  std::optional<double> sample_rate_hz = {};        ///< as stated; must agree with a time column
  std::optional<std::pair<int, int>> samples = {};  ///< scored: first, one past the last
  int lead_in = 0;                                  ///< samples before those
  /// Excitations held no frequency above half the rate: they are upsampled by a sinc. Else they are
  /// linear between their samples.
  bool band_limited = false;
  bool resample = false;  ///< time steps are uneven: the record is interpolated at an even rate
  std::optional<int> upsample =
      {};  ///< none: until linear interpolation loses 0.3 % of the amplitude
};

/// Puts a record's rate, window and signals into the case, and compares the spectrum of each
/// channel's window with that of its whole. Throws InvalidInput (channel, sample_rate, samples,
/// lead_in), and io::FileError for numbers that are missing in the window or uneven in time.
void take_record(SidCase& sid_case, const signals::Record& record, const RecordUse& use);

/// What the record itself makes one doubt: windows that are not like it, excitations that are not
/// linear between their samples, units that nobody converts.
[[nodiscard]] std::vector<Remark> record_remarks(const SidCase& sid_case);

/// How far the responses show that the window does not start at rest; none where they show that it
/// does, or nothing: a displacement or velocity (its first samples against its root mean square, by
/// more than a tenth and three standard errors), an acceleration only where the window starts
/// within the record (its first quarter of a period).
[[nodiscard]] std::optional<double> moves_at_start(const SidCase& sid_case);

/// Makes the model's initial state unknown: normal priors about 0. Scales: the sd of the mass's own
/// displacement, or that of a velocity or acceleration over ω or ω², ω the root mean square
/// frequency of its spectrum; a mass without a sensor takes the largest of the others'. Throws
/// InvalidInput (initial) where the responses are constant.
void infer_initial(SidCase& sid_case, SidModel& model);

}  // namespace wheeltap::identification
