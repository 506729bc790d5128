// The part of a system-identification case that simulates its record.
#pragma once

#include "apps/cases/sid_case.hpp"

namespace wheeltap::apps {

/// The case is simulated, and its truth moves the base, or gives the base's displacement.
[[nodiscard]] bool truth_moves_base(const Json& json);
[[nodiscard]] bool truth_displaces_base(const Json& json);

/// The true model and its parameters, where the case has a truth; channels of its excitations,
/// which are measured exactly, also where no channel asks for it. Parameters, channels and models
/// must be there already.
void parse_truth(SidCaseFile& parsed);

/// What drives the true model; reads the files that it names.
void parse_excitations(SidCaseFile& parsed);

}  // namespace wheeltap::apps
