// The page of a monitoring run.
#pragma once

#include <optional>
#include <string>

#include "apps/results/summary.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::apps {

/// Returns one HTML file without scripts, from summary.json and series.csv. The page shows each
/// feature with its 95 % prediction interval, each feature corrected for weather, P(changed) and
/// the alarm statistic over time. The page also shows onset and shifts of each alarm, comparison
/// charts if any, and warnings. For long series, figures show minimum and maximum of about 700
/// intervals. Throws nlohmann exceptions and std::invalid_argument for a summary or a table of
/// another kind.
[[nodiscard]] std::string monitor_page(const Report& summary, const io::Columns& series,
                                       const std::optional<io::Columns>& charts = {});

}  // namespace wheeltap::apps
