// The page of a monitoring run.
#pragma once

#include <optional>
#include <string>

#include "apps/results/summary.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::apps {

/// One HTML file without scripts, of summary.json and series.csv: each feature with its predicted
/// band and corrected for weather, P(changed) and the alarm statistic over time, onset and shifts
/// of each alarm, the comparison charts where there are some, warnings. Of long series each chart
/// shows the extremes of about 700 intervals. Throws nlohmann exceptions and std::invalid_argument
/// for a summary or a table of another kind.
[[nodiscard]] std::string monitor_page(const Report& summary, const io::Columns& series,
                                       const std::optional<io::Columns>& charts = {});

}  // namespace wheeltap::apps
