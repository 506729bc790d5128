// HTML page of identified modes.
#pragma once

#include <string>

#include "apps/cases/records/modes_file.hpp"
#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// Returns one self-contained HTML file from summary.json and modes.json. The page has a table of
/// the modes, their shapes on the geometry and by channel, MAC and complexity. The page also has
/// the stabilisation diagram over the spectrum and the damping ratios, both with 95 % intervals,
/// and the reasons for doubtful modes and rejected poles. With several set-ups, the page
/// begins with the merged modes and the agreement of the set-ups. Throws nlohmann exceptions,
/// std::out_of_range and std::invalid_argument for an invalid summary.
[[nodiscard]] std::string modal_page(const Report& summary, const ModesFile& modes);

}  // namespace wheeltap::apps
