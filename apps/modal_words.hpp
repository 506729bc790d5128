// What is said of identified modes, whoever prints it.
#pragma once

#include <string>
#include <vector>

#include "signals/modal_identification.hpp"

namespace wheeltap::apps {

/// Why a mode is doubtful, each half a sentence; empty where it is not.
[[nodiscard]] std::vector<std::string> doubts_in_words(const signals::Mode& mode);

/// What was done, a sentence each: decimation, lags, blocks, orders.
[[nodiscard]] std::vector<std::string> procedure_in_words(const signals::ModalResult& result);

/// What a reader should keep in mind of the whole.
[[nodiscard]] std::vector<std::string> warnings(const signals::ModalResult& result);

/// "1.2284 ± 0.0012": two digits of the standard deviation.
[[nodiscard]] std::string with_sd(double x, double sd);

}  // namespace wheeltap::apps
