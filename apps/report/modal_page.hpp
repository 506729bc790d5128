// A page that draws identified modes.
#pragma once

#include <string>

#include "apps/cases/records/modes_file.hpp"
#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// One HTML file without anything from elsewhere, of what summary.json and modes.json keep: the
/// modes in a table, their shapes on the geometry and by channel, MAC, complexity, the
/// stabilisation diagram with intervals over the spectrum, damping with intervals, what is
/// doubtful, what was rejected, and why. Of several set-ups, the merged modes first, and how the
/// set-ups agree. Throws nlohmann exceptions, std::out_of_range and std::invalid_argument for a
/// summary that is none.
[[nodiscard]] std::string modal_page(const Report& summary, const MeasuredModes& modes);

}  // namespace wheeltap::apps
