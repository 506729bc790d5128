// The laws of a chain's links as curves: what a system identification found, drawn.
#pragma once

#include <optional>
#include <vector>

#include "identification/sid_problem.hpp"
#include "inference/reversible_jump.hpp"

namespace wheeltap::identification {

/// The tension at rest [N] (dynamics/link_tension.hpp) that a model's draws give a link, over the
/// extensions [m] that it goes through at the posterior mean.
struct LinkCurve {
  int a = 0, b = 0;  ///< the masses it joins
  std::vector<double> extension;
  std::vector<double> q2_5, q50, q97_5;  ///< of the tension
};

/// One a link of a drawn model, but for links that no draw can move; none where the model's
/// response fails at the posterior mean. At most 400 draws, evenly spread over the chains.
[[nodiscard]] std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                              const inference::Posterior& posterior,
                                                              int model);

}  // namespace wheeltap::identification
