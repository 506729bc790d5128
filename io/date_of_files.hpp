// The creation date that is written into files.
#pragma once

#include <ctime>

namespace wheeltap::io {

/// The current time, or SOURCE_DATE_EPOCH [s since 1970] if that is set, for reproducible files.
/// Throws std::invalid_argument if it is not a whole number of seconds before the year 10000.
[[nodiscard]] std::time_t date_of_files();

}  // namespace wheeltap::io
