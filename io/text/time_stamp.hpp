// Dates and times of day, as printed by loggers.
//
//   stamp = [weekday] date | [weekday] date (blank | T | _ | ,) time [zone] | time [zone]
//         | [weekday] Mar 1 10:00:00 2021 | yyyymmddhhmmss[fraction]
//   date  = 2021-03-01 | 2021/3/1 | 20210301 | 01.03.2021 | 01-Mar-2021 | 01/03/2021 (either order)
//         | 2021-060 (the day of the year, before T)
//   time  = hh:mm[:ss[(.|,|:)fraction]] [AM|PM] | hhmmss[.fraction] (after a date without marks)
//         | hh.mm.ss and hh-mm-ss (after a date)
//   zone  = Z | UTC | GMT | (+|-)hh[[:]mm] | the letters of another, which are ignored
//
// If the order of day and month is ambiguous, the caller states it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

struct TimeStamp {
  /// Time since 1970-01-01 00:00 in UTC, or in local time if the text has no zone; without a date,
  /// time since midnight.
  std::int64_t nanoseconds = 0;
  bool has_date = true;
  int decimals = 0;  ///< number of decimals of the seconds
};

enum class DayOrder { unknown, day_first, month_first };

/// Parses a text as a stamp in one of the forms above. `ambiguous` is true, and the stamp is empty,
/// if the order of day and month is unknown and both orders are possible.
struct StampReading {
  std::optional<TimeStamp> stamp = {};
  bool ambiguous = false;
  DayOrder order = DayOrder::unknown;  ///< known if one of the two numbers is above 12
};
[[nodiscard]] StampReading read_stamp(std::string_view text, DayOrder order = DayOrder::unknown);

/// Parses the text in the form `time_format`: "%d.%m.%Y %H:%M:%S" (%Y %y %m %b %d %H %I %M %S %f %p
/// %z; seconds may have a fraction).
[[nodiscard]] std::optional<TimeStamp> read_stamp(std::string_view text,
                                                  const std::string& pattern);

/// The strptime pattern of a time stamp; empty if the text has no common form.
[[nodiscard]] std::string stamp_pattern(std::string_view text, DayOrder order);

/// A time-stamp format given in a case or by a user.
struct TimeFormat {
  DayOrder order = DayOrder::unknown;
  std::string pattern = {};  ///< for strptime; empty: any of the forms above
};
/// Accepts "day-first", "month-first", "iso", a pattern with %, or a pattern of letters
/// ("dd.MM.yyyy HH:mm:ss"). Returns nothing for other texts.
[[nodiscard]] std::optional<TimeFormat> parse_time_format(std::string_view text);

/// "2021-03-01 10:00:00.010", or "10:00:00.010" without a date.
[[nodiscard]] std::string text_of(const TimeStamp& stamp);

}  // namespace wheeltap::io
