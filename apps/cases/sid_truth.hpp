// The truth of a system-identification case, from which its record is simulated.
#pragma once

#include "apps/cases/sid_case.hpp"

namespace wheeltap::apps {

/// True if the record is simulated and the base moves in the truth. The next function is true if,
/// in addition, the truth gives the displacement of the base.
[[nodiscard]] bool truth_moves_base(const Json& json);
[[nodiscard]] bool truth_displaces_base(const Json& json);

/// Parses the true model and its parameters if the case has a truth. For each excitation without a
/// channel, a channel without noise is added. Parameters, channels and models must be parsed
/// before.
void parse_truth(SidCaseFile& parsed);

/// Parses the excitations of the true model and reads their files.
void parse_excitations(SidCaseFile& parsed);

}  // namespace wheeltap::apps
