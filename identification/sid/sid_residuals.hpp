// How the residuals of a record are correlated, chosen where the case leaves it open.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Largest order that is chosen from.
inline constexpr int kMostAutoregressive = 20;

/// Gives the residuals of each response an autoregression of this order, whose partial
/// autocorrelations are parameters of the case with priors U(-1, 1): "ar[1]" …, with several
/// responses "ar[2][1]" …, the same in every model that has them.
void add_autoregression(SidCase& sid_case, SidModel& model, int order);

/// For every model that leaves its order open (SidModel::chooses_order): fits it with white
/// residuals (inference::search_modes, from 30 draws of the prior), and takes the largest of the
/// orders that its responses' residuals at the weightiest mode ask for
/// (signals::autoregressive_order); of several records it looks at the first. A model that fits
/// nothing keeps white residuals. The choice comes from the record itself, so that probabilities
/// between models are conditional on it.
void choose_orders(SidCase& sid_case, std::uint64_t seed, int threads);

}  // namespace wheeltap::identification
