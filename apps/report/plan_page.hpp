// The page of a plan.
#pragma once

#include <string>

#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// Returns one HTML file without scripts, from summary.json. A drawing of the structure shows the
/// recommended design and the smallest detectable severity at every location. The page also shows
/// detection curves, the ranking of designs, the value of further sensors, longer records, modes
/// and masses, costs, and warnings. Throws nlohmann exceptions for a summary of another kind.
[[nodiscard]] std::string plan_page(const Report& summary);

}  // namespace wheeltap::apps
