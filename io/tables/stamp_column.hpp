// The time stamps of a column of a table.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/text/time_stamp.hpp"

namespace wheeltap::io {

/// Reads the time stamps of a column as seconds since the first time stamp. For times of day
/// without a date, the seconds increase beyond midnight.
class StampColumn {
 public:
  /// `stated` is the "time_format" of the case, for messages; empty: the format is detected.
  StampColumn(TimeFormat format, std::string stated)
      : format_(std::move(format)), stated_(std::move(stated)) {}

  /// Writes the seconds of the next time stamp to `seconds`. Returns an empty string if `text` was
  /// read. Otherwise returns the second part of an error message whose first part is `text`.
  [[nodiscard]] std::string read(std::string_view text, double& seconds);
  [[nodiscard]] const std::optional<TimeStamp>& first() const { return first_; }
  /// Largest number of decimals of the seconds in the column.
  [[nodiscard]] int decimals() const { return decimals_; }
  /// The pattern of the time stamps.
  [[nodiscard]] std::string pattern() const;

 private:
  TimeFormat format_;
  std::string stated_, first_text_;
  std::optional<TimeStamp> first_, last_;
  std::int64_t days_ = 0;
  int decimals_ = 0;
};

}  // namespace wheeltap::io
