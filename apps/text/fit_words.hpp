// Sentences on misfit: the reasons why models do not explain the data, and advice.
#pragma once

#include <string>
#include <vector>

#include "identification/findings/fit_verdict.hpp"

namespace wheeltap::apps {

/// Returns one sentence per kind of reason, with advice on what to check.
[[nodiscard]] std::vector<std::string> in_words(const identification::FitVerdict& verdict);

/// Returns the most serious reason, for a headline: "R² -0.28 for "a"", "the residual of "a" is 14
/// % of the response and not noise". `verdict` must contain a reason.
[[nodiscard]] std::string in_brief(const identification::FitVerdict& verdict);
[[nodiscard]] std::string in_brief(const identification::misfit::Reason& reason);

/// Returns " (frequencies with errors above 3 sd: modes 1 to 3). Check the model's …".
[[nodiscard]] std::string what_to_check(const std::vector<int>& modes, bool emulated);
/// Returns the coefficient of variation of the noise: " of 20 %". The text is empty if `cv` is not
/// finite, that is, if the coefficient differs between modes.
[[nodiscard]] std::string stated(double cv);

}  // namespace wheeltap::apps
