// HTML page of identified modes.
#pragma once

#include <string>

#include "apps/cases/records/modes_file.hpp"
#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// Returns one self-contained HTML file from summary.json and modes.json. It has a table of the
/// modes, their shapes on the geometry and by channel, MAC and complexity; the stabilisation
/// diagram with intervals over the spectrum, and damping with intervals; doubts and rejected poles
/// with reasons. With several set-ups it begins with the merged modes and their agreement. Throws
/// nlohmann exceptions, std::out_of_range and std::invalid_argument for an invalid summary.
[[nodiscard]] std::string modal_page(const Report& summary, const MeasuredModes& modes);

}  // namespace wheeltap::apps
