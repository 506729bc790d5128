// The residual models of a case: their parameters, and the choice where the case leaves it open.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Gives each response of `model` this residual model, whose parameters become parameters of the
/// case, the same in every model that has them.
void add_residuals(SidCase& sid_case, SidModel& model,
                   std::shared_ptr<const ResidualModel> residuals);

/// For every model that leaves its residual model open (SidResiduals::chosen_kind): fits it with
/// white residuals (inference::search_modes, from 30 draws of the prior), and takes the largest of
/// the values that its responses' residuals at the weightiest mode ask for (ResidualKind::choose);
/// of several records it looks at the first. A model that fits nothing keeps white residuals. The
/// choice comes from the record itself, so that probabilities between models are conditional on it.
void choose_residuals(SidCase& sid_case, std::uint64_t seed, int threads);

}  // namespace wheeltap::identification
