// The section of a monitoring page that explains changes of the structure.
#pragma once

#include <string>

#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// Returns the section for `monitor`, /monitor of a summary; empty if no alarm has an explanation.
[[nodiscard]] std::string explanation_section(const Report& monitor);

}  // namespace wheeltap::apps
