// Residual models of a case: their parameters and their automatic choice.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Gives each response of `model` this residual model. Its parameters become parameters of the
/// case, shared by all models that have them.
void add_residuals(SidCase& sid_case, SidModel& model,
                   std::shared_ptr<const ResidualModel> residuals);

/// Chooses the residual model of every model with SidResiduals::chosen_kind. Fits the model with
/// white residuals (inference::search_modes, from 30 draws of the prior) to the first record, and
/// takes the largest value that its responses' residuals at the dominant mode require
/// (ResidualKind::choose). If no fit of a model is found, its residuals remain white. The choice
/// uses the same record, so model probabilities are conditional on it.
void choose_residuals(SidCase& sid_case, std::uint64_t seed, int threads);

}  // namespace wheeltap::identification
