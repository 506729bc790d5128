// The truth of a system-identification case, from which its record is simulated.
#pragma once

#include "apps/cases/sid_case.hpp"

namespace wheeltap::apps {

/// True if the record is simulated and the base of the true model moves. truth_displaces_base is
/// true if, in addition, the truth gives the displacement of the base.
[[nodiscard]] bool truth_moves_base(const Json& json);
[[nodiscard]] bool truth_displaces_base(const Json& json);

/// Parses the true model and its parameters if the case has a truth. For each excitation without a
/// channel, a channel without noise is added. Call this function after the parameters, channels and
/// models are parsed.
void parse_truth(SidCaseFile& parsed);

/// Parses the excitations of the true model and reads their files.
void parse_excitations(SidCaseFile& parsed);

}  // namespace wheeltap::apps
