// Posterior natural frequencies and damping ratios of a chain of masses.
#pragma once

#include <vector>

#include "identification/findings/marginal.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Posterior of a vibration mode of the chain's linear part (dynamics/linear_modes.hpp).
struct ChainMode {
  Marginal frequency_hz, damping_ratio;
};

/// Computes the modes of a model with draws, sorted by frequency, from at most 500 evenly spaced
/// draws per Markov chain. The result is empty if the number of modes differs between draws.
[[nodiscard]] std::vector<ChainMode> chain_modes(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

}  // namespace wheeltap::identification
