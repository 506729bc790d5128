// The key `poles` of a modal case: poles that the user chose in the stabilisation diagram.
#pragma once

#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "signals/modal/stabilisation.hpp"

namespace wheeltap::apps {

/// The poles at /poles; empty if the case has none. `several` is true for a case of several
/// records. Throws Failure (65) if the method has no stabilisation diagram, or if there are several
/// diagrams.
[[nodiscard]] std::vector<signals::ChosenPole> chosen_poles(const CaseFile& file, bool several);

}  // namespace wheeltap::apps
