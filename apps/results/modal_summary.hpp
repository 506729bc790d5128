// summary.json of a modal case.
#pragma once

#include "apps/cases/modal_case.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// "modes", "procedure", "spectrum", "stabilisation", … of one record; of several the merged modes
/// and "set_ups"; "geometry" where there is one, and "diagnostics".
[[nodiscard]] Report modal_summary(const ModalCaseFile& modal, const IdentifiedModes& found);

}  // namespace wheeltap::apps
