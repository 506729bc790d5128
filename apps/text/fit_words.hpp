// Misfit in words: what heads an answer whose models do not explain the data, and what to do.
#pragma once

#include <string>
#include <vector>

#include "identification/findings/fit_verdict.hpp"

namespace wheeltap::apps {

/// A sentence a reason, with what to check.
[[nodiscard]] std::vector<std::string> in_words(const identification::FitVerdict& verdict);

/// "R² -0.28", "the residual of "a" is 14 % of the response and no noise": the gravest reason, for
/// a headline. The verdict must have one.
[[nodiscard]] std::string in_brief(const identification::FitVerdict& verdict);
[[nodiscard]] std::string in_brief(const identification::misfit::Reason& reason);

/// " (off by more than 3 sd: modes 1 to 3). Check the beam's properties …"
[[nodiscard]] std::string what_to_check(const std::vector<int>& modes, bool emulated);
/// " of 20 %"; empty where it differs from mode to mode.
[[nodiscard]] std::string stated(double cv);

}  // namespace wheeltap::apps
