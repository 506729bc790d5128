// Residual models of a case: their parameters and their automatic choice.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Sets the residual model of each response of `model`. The parameters of the residual model become
/// parameters of the case. All models with this residual model share them.
void add_residuals(SidCase& sid_case, SidModel& model,
                   std::shared_ptr<const ResidualModel> residuals);

/// Chooses the residual model of every model with SidResiduals::chosen_kind. Fits the model with
/// white residuals (inference::search_modes, from 30 draws of the prior) to the first record, and
/// takes the largest value that its responses' residuals at the dominant posterior mode require
/// (ResidualKind::choose). If no fit of a model is found, its residual model remains white. The
/// choice uses the same record as the inference, so model probabilities are conditional on the
/// choice.
void choose_residuals(SidCase& sid_case, std::uint64_t seed, int threads);

}  // namespace wheeltap::identification
