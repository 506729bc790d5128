// Dates and times of day, as loggers print them.
//
//   stamp = [weekday] date | [weekday] date (blank | T | _ | ,) time [zone] | time [zone]
//         | [weekday] Mar 1 10:00:00 2021 | yyyymmddhhmmss[fraction]
//   date  = 2021-03-01 | 2021/3/1 | 20210301 | 01.03.2021 | 01-Mar-2021 | 01/03/2021 (either order)
//         | 2021-060 (the day of the year, before T)
//   time  = hh:mm[:ss[(.|,|:)fraction]] [AM|PM] | hhmmss[.fraction] (after a date without marks)
//         | hh.mm.ss and hh-mm-ss (after a date)
//   zone  = Z | UTC | GMT | (+|-)hh[[:]mm] | the letters of another, which are passed over
//
// A date of which both day and month may come first is read in the order that is stated.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

struct TimeStamp {
  /// Since 1970-01-01 00:00 UTC, or of the place where no zone is printed; without a date, since
  /// midnight.
  std::int64_t nanoseconds = 0;
  bool has_date = true;
  int decimals = 0;  ///< of the seconds
};

enum class DayOrder { unknown, day_first, month_first };

/// What a text is as a stamp in one of the forms above. `ambiguous`: the order of day and month is
/// not known, and both could be either; there is then no stamp.
struct StampReading {
  std::optional<TimeStamp> stamp = {};
  bool ambiguous = false;
  DayOrder order = DayOrder::unknown;  ///< that the text shows: a number above 12
};
[[nodiscard]] StampReading read_stamp(std::string_view text, DayOrder order = DayOrder::unknown);

/// The same text, in the form of `time_format`: "%d.%m.%Y %H:%M:%S" (%Y %y %m %b %d %H %I %M %S %f
/// %p %z; seconds may have a fraction).
[[nodiscard]] std::optional<TimeStamp> read_stamp(std::string_view text,
                                                  const std::string& pattern);

/// The pattern of strptime that such a text has; empty where it is none of the usual ones.
[[nodiscard]] std::string stamp_pattern(std::string_view text, DayOrder order);

/// How a case or a user may state the form of time stamps.
struct TimeFormat {
  DayOrder order = DayOrder::unknown;
  std::string pattern = {};  ///< of strptime; empty: any of the forms above
};
/// "day-first", "month-first", "iso", a pattern with %, or one of letters ("dd.MM.yyyy HH:mm:ss").
/// Nothing for what is none of these.
[[nodiscard]] std::optional<TimeFormat> parse_time_format(std::string_view text);

/// "2021-03-01 10:00:00.010", or "10:00:00.010" without a date.
[[nodiscard]] std::string text_of(const TimeStamp& stamp);

}  // namespace wheeltap::io
