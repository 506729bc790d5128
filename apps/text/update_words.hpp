// What an update found, in words.
#pragma once

#include <string>
#include <vector>

#include "apps/text/answer.hpp"
#include "identification/structural/updating/update_findings.hpp"

namespace wheeltap::apps {

/// What the data tell, in two sentences.
[[nodiscard]] Answer answer(const identification::UpdateFindings& findings);

/// Why the structure does not explain the modes: empty where it does.
[[nodiscard]] std::vector<std::string> misfit_sentences(
    const identification::UpdateFindings& findings);
/// That the posterior has separate solutions, and how to tell them apart; empty where it has one.
[[nodiscard]] std::vector<std::string> solution_sentences(
    const identification::UpdateFindings& findings);
/// That the numbers of modes without shapes are doubtful, and what to do; empty where they are not.
[[nodiscard]] std::string numbering_sentence(const identification::UpdateFindings& findings);
/// What the data cannot tell: parameters left at their priors, those that cannot be told apart, and
/// directions in which nothing was learnt.
[[nodiscard]] std::vector<std::string> cannot_tell(const identification::UpdateFindings& findings);
/// All that a reader should keep in mind, the gravest first.
[[nodiscard]] std::vector<std::string> update_warnings(
    const identification::UpdateFindings& findings);

/// "0.8 · k1 - 0.6 · k2".
[[nodiscard]] std::string in_words(const identification::UntouchedDirection& direction);
/// "mode 2 as computed mode 3"; empty where a mode is matched to its own place in every draw.
[[nodiscard]] std::string matched_in_words(const identification::ModeFinding& mode);

}  // namespace wheeltap::apps
