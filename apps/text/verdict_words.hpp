// What a run's verdict says to people: sentences of its typed reasons, each with what to do about
// it in the program's own terms.
#pragma once

#include <string>
#include <vector>

#include "inference/diagnosis/reason.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::apps {

/// In the order of the reasons. What says that the chains have not converged is one sentence; of
/// many models alike the first four are named and the rest counted.
[[nodiscard]] std::vector<std::string> in_words(const std::vector<inference::Reason>& reasons,
                                                const inference::ModelSpace& space);

}  // namespace wheeltap::apps
