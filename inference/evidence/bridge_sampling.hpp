// Bridge sampling: the evidence from posterior draws and draws of a proposal that resembles it.
#pragma once

#include <cstdint>

#include "inference/evidence/metropolis.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {

struct BridgeOptions {
  std::uint64_t seed = 1;
  int proposal_draws = 0;  ///< 0: as many as posterior draws are used
  int threads = 0;         ///< 0: as many as the machine has. Never changes a result.
  NormalMixture::FitOptions fit{};
};

struct Bridge {
  double log_evidence = 0.0;
  double standard_error = 0.0;   ///< of ln Z
  double effective_draws = 0.0;  ///< of the posterior's side
  bool settled = false;          ///< the iteration found its fixed point
};

/// The bridge alone, from ln l = ln π - ln q at posterior draws, chains kept apart and of one
/// length, and at draws of q; see below.
[[nodiscard]] Bridge bridge(const ChainsOf& at_posterior, const std::vector<double>& at_proposal);

/// Meng & Wong (1996, Statistica Sinica 6:831) with their optimal bridge. With q a normal mixture
/// fitted to the first half of each chain, l = π/q the ratio at the second half's draws (1) and at
/// draws of q (2),
///
///   Z ← Σ₂ l / (s₁ l + s₂ Z) / n₂  ÷  Σ₁ 1 / (s₁ l + s₂ Z) / n₁
///
/// is iterated to its fixed point, s being the shares of the sample sizes, the posterior's the
/// effective one. The standard error is the delta method's with the autocorrelation of the
/// posterior draws (Frühwirth-Schnatter 2004, Econometrics Journal 7:143, section 3.2).
///
/// Throws std::invalid_argument for fewer than 20 draws a chain.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model,
                                       const ModelSamples& samples, const BridgeOptions& options);

/// With nothing given: a TMCMC pilot, four chains that renew themselves from it, and the bridge.
/// The chains are of 5000 draws; where that leaves a warning they are drawn anew, four and sixteen
/// times as long. Where the pilot has no ln Z, neither has this: NaN, with the pilot's warning.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model,
                                       const BridgeOptions& options);

/// The same with a pilot that has been run already.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model, const Tmcmc& pilot,
                                       const BridgeOptions& options);

}  // namespace wheeltap::inference
