// When files say that they were made.
#pragma once

#include <ctime>

namespace wheeltap::io {

/// Now, or SOURCE_DATE_EPOCH [s since 1970], where that is set, for files that are to be the same.
/// Throws std::invalid_argument where it is no whole number of seconds before the year 10000.
[[nodiscard]] std::time_t date_of_files();

}  // namespace wheeltap::io
