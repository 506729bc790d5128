// Whether an emulator moved the answer: a run's own draws, evaluated with the FE solution.
#pragma once

#include "apps/damage_problem.hpp"
#include "apps/summary.hpp"

namespace wheeltap::apps {

/// Importance weights w = p(data | FE) / p(data | emulator) of up to `most` draws spread evenly
/// over the chains turn the sampled posterior into that of the FE solution:
///
///   P(m | FE) ≈ Σ_{draws in m} w / Σ w,
///
/// and so for means. Reports both answers with the standard errors of their difference, the
/// effective share of the draws (Σw)² / (n Σw²), the Pareto shape of the weights (beyond 0.7 they
/// say nothing but that the two posteriors differ), and the emulator's error at the draws. Warns,
/// in words, where the answer moved. Null where no emulator takes part in the likelihood.
[[nodiscard]] Report check_emulator(const DamageProblem& problem,
                                    const inference::Posterior& posterior,
                                    std::vector<std::string>& warnings, int most = 2000);

}  // namespace wheeltap::apps
