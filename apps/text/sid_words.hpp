// What only system identifications have to say, in words.
#pragma once

#include <string>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_case.hpp"

namespace wheeltap::apps {

[[nodiscard]] std::string sentence(const identification::remark::ScatterBetweenWindows& remark);
[[nodiscard]] std::string sentence(const identification::remark::WindowsUnsound& remark);

/// What the residuals of a model were taken for where the case leaves it open; empty where it does
/// not.
[[nodiscard]] std::string residuals_note(const identification::SidModel& model);

}  // namespace wheeltap::apps
