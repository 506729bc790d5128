// summary.json of a modal case.
#pragma once

#include "apps/cases/modal_case.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// Returns "modes", "procedure", "spectrum", "stabilisation", … of one record; for several records
/// the merged modes and "set_ups"; "geometry" if the case has one; "diagnostics".
[[nodiscard]] Report modal_summary(const ModalCaseFile& modal, const IdentifiedModes& found);

}  // namespace wheeltap::apps
