// The creation date that Wheeltap writes into files.
#pragma once

#include <ctime>

namespace wheeltap::io {

/// Returns the current time or, for reproducible files, SOURCE_DATE_EPOCH [s since 1970] if this
/// environment variable is set. Throws std::invalid_argument if SOURCE_DATE_EPOCH is not a whole
/// number of seconds before the year 10000.
[[nodiscard]] std::time_t date_of_files();

}  // namespace wheeltap::io
