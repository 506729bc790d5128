// A page that draws identified modes.
#pragma once

#include <string>

#include "apps/modal_case.hpp"

namespace wheeltap::apps {

/// One HTML file without anything from elsewhere: the modes in a table, the stabilisation diagram
/// with intervals over the spectrum, damping with intervals, what is doubtful and why.
[[nodiscard]] std::string modal_page(const ModalCaseFile& modal,
                                     const signals::ModalResult& result);

}  // namespace wheeltap::apps
