// Sentences that only system identification uses.
#pragma once

#include <string>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_case.hpp"

namespace wheeltap::apps {

[[nodiscard]] std::string sentence(const identification::remark::ScatterBetweenWindows& remark);
[[nodiscard]] std::string sentence(const identification::remark::WindowsUnsound& remark);

/// Returns a note on the residual model that Wheeltap chose for a model; empty if the case states
/// the residual model.
[[nodiscard]] std::string residuals_note(const identification::SidModel& model);

}  // namespace wheeltap::apps
