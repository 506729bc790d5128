#include "apps/cases/monitoring/monitor_simulation.hpp"

#include <algorithm>

#include "apps/cases/monitoring/monitor_truth.hpp"
#include "apps/starter_texts.hpp"

namespace wheeltap::apps {

std::string simulated_series_csv(std::uint64_t seed) {
  const auto* found = std::ranges::find_if(
      kStarterTexts, [](const auto& entry) { return entry.first == "monitor.json"; });
  return simulated_table({.path = "monitor.json", .json = Json::parse(found->second)}, seed).csv;
}

}  // namespace wheeltap::apps
