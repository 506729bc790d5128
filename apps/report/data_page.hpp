// HTML page of a measured file.
#pragma once

#include <string>

#include "apps/cases/records/measured_file.hpp"

namespace wheeltap::apps {

/// Returns one self-contained HTML file with the time history of each channel (its envelope if
/// there are more samples than pixels), its spectrum with marked peaks, and its faults.
[[nodiscard]] std::string data_page(const MeasuredFile& file);

}  // namespace wheeltap::apps
