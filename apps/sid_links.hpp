// The laws of a chain's links as curves: what a system identification found, drawn.
#pragma once

#include "apps/sid_problem.hpp"
#include "apps/summary.hpp"

namespace wheeltap::apps {

/// For every model of at least 5 % and each of its links:
///   {"between": [a, b], "extension": [m, …], "tension": {"q2.5": [N, …], "q50": …, "q97.5": …}},
/// the tension at rest (dynamics/link_tension.hpp) under the model's draws, over the extensions
/// that the link goes through at the posterior mean. Left out: a link that no draw can move, and
/// all of a model whose response fails there.
[[nodiscard]] Report link_laws(const SidProblem& problem, const inference::Posterior& posterior,
                               const Report& models);

}  // namespace wheeltap::apps
