// Sentences of a run's convergence verdict, each with the option that helps.
#pragma once

#include <string>
#include <vector>

#include "inference/diagnosis/reason.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::apps {

/// Returns sentences in the order of the reasons. All reasons why the chains have not converged
/// form one sentence. If one reason holds for many models, the first four are named and the others
/// counted.
[[nodiscard]] std::vector<std::string> in_words(const std::vector<inference::Reason>& reasons,
                                                const inference::ModelSpace& space);

}  // namespace wheeltap::apps
