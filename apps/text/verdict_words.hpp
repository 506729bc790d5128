// Sentences on the reasons why a run has not converged, each with the option that helps.
#pragma once

#include <string>
#include <vector>

#include "inference/diagnosis/reason.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::apps {

/// Returns sentences in the order of the reasons. One sentence contains all reasons that concern
/// the mixing of the chains. If a reason applies to many models, the sentence names the first four
/// and the number of others.
[[nodiscard]] std::vector<std::string> in_words(const std::vector<inference::Reason>& reasons,
                                                const inference::ModelSpace& space);

}  // namespace wheeltap::apps
