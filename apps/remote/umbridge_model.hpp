// A model behind a server, by the UM-Bridge protocol: HTTP and JSON.
#pragma once

#include <memory>

#include "apps/cases/outside_case.hpp"

namespace wheeltap::apps {

/// Whether this program was built with what servers need.
[[nodiscard]] bool knows_http();

/// The model of protocol version 1 (Seelinger et al. 2023, UM-Bridge: Uncertainty quantification
/// and modeling bridge; its page "UM-Bridge HTTP protocol"). /Info and /ModelInfo say which models
/// there are and whether they have derivatives, /InputSizes and /OutputSizes their vectors: x is
/// cut into those, y joined from them. Each thread has a connection of its own. A server that does
/// not answer, or says 5xx, is asked again after ¼, ½, 1 … seconds; other answers are final.
/// Throws OutsideModelError.
[[nodiscard]] std::unique_ptr<identification::OutsideModel> umbridge_model(const UmbridgeSpec& spec,
                                                                           int inputs, int outputs);

}  // namespace wheeltap::apps
