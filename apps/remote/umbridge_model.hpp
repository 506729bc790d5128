// Client of the UM-Bridge protocol (HTTP and JSON): models on a server.
#pragma once

#include <memory>

#include "apps/cases/outside_case.hpp"

namespace wheeltap::apps {

/// Returns true if this program was built with HTTP support.
[[nodiscard]] bool knows_http();

/// Opens a model of a server by version 1 of the UM-Bridge protocol (Seelinger et al. 2023,
/// UM-Bridge: Uncertainty quantification and modeling bridge; page "UM-Bridge HTTP protocol" of
/// this project). /Info and /ModelInfo list the models and their derivatives; /InputSizes and
/// /OutputSizes give the vector sizes. x is split into the input vectors, and y is the
/// concatenation of the output vectors. Each thread has its own connection. If a server does not
/// respond or responds with a status 5xx, the request is repeated after ¼, ½, 1 … seconds. Other
/// responses are final. Throws OutsideModelError.
[[nodiscard]] std::unique_ptr<identification::OutsideModel> umbridge_model(const UmbridgeSpec& spec,
                                                                           int inputs, int outputs);

}  // namespace wheeltap::apps
