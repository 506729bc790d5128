// The key `poles` of a modal case: poles of the stabilisation diagram, chosen by hand.
#pragma once

#include "apps/cases/modal/modal_case.hpp"

namespace wheeltap::apps {

/// Reads /poles into the options of a set-up. Throws Failure (65) for a method without a diagram of
/// this kind, and for several diagrams.
void take_poles(const ModalCaseFile& modal, SetUp& set_up);

}  // namespace wheeltap::apps
