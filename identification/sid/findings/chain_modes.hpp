// Natural frequencies and damping ratios that the draws give a chain.
#pragma once

#include <vector>

#include "identification/findings/marginal.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// A mode of the chain's linear part (dynamics/linear_modes.hpp).
struct ChainMode {
  Marginal frequency_hz, damping_ratio;
};

/// Of a drawn model, in the order of their frequency; at most 500 draws a chain, evenly spread.
/// Empty where draws have different numbers of modes.
[[nodiscard]] std::vector<ChainMode> chain_modes(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

}  // namespace wheeltap::identification
