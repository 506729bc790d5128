#include "io/tables/stamp_column.hpp"

#include <algorithm>

namespace wheeltap::io {

std::string StampColumn::read(std::string_view text, double& seconds) {
  std::optional<TimeStamp> stamp;
  if (format_.pattern.empty()) {
    stamp = read_stamp(text, format_.order).stamp;
  } else {
    stamp = read_stamp(text, format_.pattern);
  }
  if (!stamp)
    return " is not a time stamp" + (stated_.empty() ? std::string(" like those above")
                                                     : " of the form \"" + stated_ + "\"");
  if (first_ && stamp->has_zone != first_->has_zone)
    return ": state the offset from UTC in all rows or in no row";
  if (!first_) {
    first_ = last_ = stamp;
    first_text_ = text;
  }
  constexpr std::int64_t kDay = 86'400'000'000'000;
  stamp->nanoseconds += days_ * kDay;
  if (!stamp->has_date && stamp->nanoseconds < last_->nanoseconds - kDay / 2) {
    ++days_;
    stamp->nanoseconds += kDay;
  }
  last_ = stamp;
  decimals_ = std::max(decimals_, stamp->decimals);
  seconds = 1e-9 * static_cast<double>(stamp->nanoseconds - first_->nanoseconds);
  return {};
}

std::string StampColumn::pattern() const {
  return format_.pattern.empty() ? stamp_pattern(first_text_, format_.order) : format_.pattern;
}

}  // namespace wheeltap::io
