// Residual models of a case: their parameters and their automatic choice.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Sets the residual model of each response of `model`. The parameters of the residual model become
/// parameters of the case. Models with the same residual model share these parameters.
void add_residuals(SidCase& sid_case, SidModel& model,
                   std::shared_ptr<const ResidualModel> residuals);

/// Chooses the residual model of every model for which SidResiduals::chosen_kind is set. The
/// function fits the model with white residuals to the first record (inference::search_modes, from
/// 30 prior draws). For each response, ResidualKind::choose selects a value (for example an
/// autoregressive order) from its residuals at the dominant posterior mode. The largest value is
/// used. If no fit is found, the residual model remains white. The choice uses the same record as
/// the inference, so model probabilities are conditional on the choice.
void choose_residuals(SidCase& sid_case, std::uint64_t seed, int threads);

}  // namespace wheeltap::identification
