// Dates and times of day in the forms that loggers print.
//
//   stamp = [weekday] date | [weekday] date (blank | T | _ | ,) time [zone] | time [zone]
//         | [weekday] Mar 1 10:00:00 2021 | yyyymmddhhmmss[fraction]
//   date  = 2021-03-01 | 2021/3/1 | 20210301 | 01.03.2021 | 01-Mar-2021 | 01/03/2021 (either order)
//         | 2021-060 (the day of the year, before T)
//   time  = hh:mm[:ss[(.|,|:)fraction]] [AM|PM] | hhmmss[.fraction] (after a date without marks)
//         | hh.mm.ss and hh-mm-ss (after a date)
//   zone = Z | UTC | GMT | (+|-)hh[[:]mm] | the letters of another time zone, which are ignored
//
// If the order of day and month is ambiguous, the caller must state the order.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

struct TimeStamp {
  /// Time since 1970-01-01 00:00: in UTC if the time stamp has a time zone, in local time if it has
  /// none. Without a date: time since midnight.
  std::int64_t nanoseconds = 0;
  bool has_date = true;
  int decimals = 0;       ///< number of decimals of the seconds
  bool has_zone = false;  ///< true if the text states the offset from UTC (Z, UTC, GMT or ±hh:mm)
};

enum class DayOrder { unknown, day_first, month_first };

/// Result of parsing a string as a time stamp in one of the forms above. If the order of day and
/// month is unknown and both orders are possible, `ambiguous` is true and `stamp` is empty.
struct StampReading {
  std::optional<TimeStamp> stamp = {};
  bool ambiguous = false;
  DayOrder order = DayOrder::unknown;  ///< known if the number of the day is above 12
};
[[nodiscard]] StampReading read_stamp(std::string_view text, DayOrder order = DayOrder::unknown);

/// Parses a string as a time stamp with this pattern, for example "%d.%m.%Y %H:%M:%S". The pattern
/// may contain %Y %y %m %b %d %H %I %M %S %f %p %z; seconds may have a fraction.
[[nodiscard]] std::optional<TimeStamp> read_stamp(std::string_view text,
                                                  const std::string& pattern);

/// Returns the strptime pattern of a time stamp, or an empty string if the time stamp has no common
/// form.
[[nodiscard]] std::string stamp_pattern(std::string_view text, DayOrder order);

/// A time-stamp format given in a case or by a user.
struct TimeFormat {
  DayOrder order = DayOrder::unknown;
  std::string pattern = {};  ///< strptime pattern; empty: any of the forms above
};
/// Accepts "day-first", "month-first", "iso", a pattern with %, or a pattern of letters
/// ("dd.MM.yyyy HH:mm:ss"). Returns std::nullopt for other strings.
[[nodiscard]] std::optional<TimeFormat> parse_time_format(std::string_view text);

/// Converts a time stamp to a string: "2021-03-01 10:00:00.010", or "10:00:00.010" without a date.
[[nodiscard]] std::string text_of(const TimeStamp& stamp);

}  // namespace wheeltap::io
