// Sentences on the results of model updating.
#pragma once

#include <string>
#include <vector>

#include "apps/text/answer.hpp"
#include "identification/structural/updating/update_findings.hpp"

namespace wheeltap::apps {

/// Returns two sentences on the information that the data contain about the parameters.
[[nodiscard]] Answer answer(const identification::UpdateFindings& findings);

/// Returns the reasons why the structure does not explain the measured modes; empty if the
/// structure explains them.
[[nodiscard]] std::vector<std::string> misfit_sentences(
    const identification::UpdateFindings& findings);
/// Returns a sentence on separate solutions and on measurements that distinguish them; empty if
/// there is only one solution.
[[nodiscard]] std::vector<std::string> solution_sentences(
    const identification::UpdateFindings& findings);
/// Returns a sentence, with advice, on modes without shapes whose mode numbers are doubtful; empty
/// if no number is doubtful.
[[nodiscard]] std::string numbering_sentence(const identification::UpdateFindings& findings);
/// Returns sentences on the limits of the data: parameters whose posteriors equal their priors,
/// pairs that the data do not distinguish, and directions without information.
[[nodiscard]] std::vector<std::string> cannot_tell(const identification::UpdateFindings& findings);
/// Returns all warnings of the run, the most serious first.
[[nodiscard]] std::vector<std::string> update_warnings(
    const identification::UpdateFindings& findings);

/// Returns a direction in parameter space as text: "0.8 · k1 - 0.6 · k2".
[[nodiscard]] std::string in_words(const identification::UntouchedDirection& direction);
/// Returns "mode 2 is the model's mode 3"; empty if the measured mode matches the model's mode with
/// the same number in every draw.
[[nodiscard]] std::string matched_in_words(const identification::ModeFinding& mode);

}  // namespace wheeltap::apps
