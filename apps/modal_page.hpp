// A page that draws identified modes.
#pragma once

#include <string>

#include "apps/modal_case.hpp"

namespace wheeltap::apps {

/// One HTML file without anything from elsewhere: the modes in a table, the stabilisation diagram
/// with intervals over the spectrum, damping with intervals, what is doubtful and why.
/// Of several set-ups, the merged modes first, and how the set-ups agree.
[[nodiscard]] std::string modal_page(const ModalCaseFile& modal, const IdentifiedModes& found);

}  // namespace wheeltap::apps
