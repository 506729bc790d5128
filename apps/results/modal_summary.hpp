// summary.json of a modal case.
#pragma once

#include "apps/cases/modal_case.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// Returns "modes", "procedure", "spectrum", "stabilisation", … of one record, or merged modes and
/// "set_ups" of several records. Also returns "diagnostics" and, if the case has one, "geometry".
[[nodiscard]] Report modal_summary(const ModalCaseFile& modal, const IdentifiedModes& found);

/// Returns poles.json, with which the application lets the user choose poles: {"set_ups": [{"file",
/// "sensors": [{"name", "node", "direction": unit vector or null}], "columns", "poles": [[order,
/// frequency, …]], "shapes": [{"real", "imaginary"}]}]}. Methods without a stabilisation diagram
/// give no poles. Entries of shapes have four decimals and refer to the quantity that their channel
/// measures.
[[nodiscard]] Report poles_with_shapes(const ModalCaseFile& modal, const IdentifiedModes& found);

}  // namespace wheeltap::apps
