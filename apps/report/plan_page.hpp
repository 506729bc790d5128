// The page of a plan.
#pragma once

#include <string>

#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// One HTML file without scripts, of summary.json: the recommended design on a drawing of the
/// structure with the smallest detectable severity of every place, curves of detection, ranking of
/// designs, value of further sensors, longer records, modes and masses, costs, warnings. Throws
/// nlohmann exceptions for a summary of another kind.
[[nodiscard]] std::string plan_page(const Report& summary);

}  // namespace wheeltap::apps
