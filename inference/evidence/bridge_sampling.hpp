// Bridge sampling: the evidence from posterior draws and from draws of a proposal distribution
// similar to the posterior.
#pragma once

#include <cstdint>

#include "inference/evidence/metropolis.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {

struct BridgeOptions {
  std::uint64_t seed = 1;
  int proposal_draws = 0;  ///< number of draws of q; 0: as many as posterior draws in use
  /// Number of threads; 0: all threads of the machine. The results do not depend on this number.
  int threads = 0;
  NormalMixture::FitOptions fit{};
};

struct Bridge {
  double log_evidence = 0.0;
  double standard_error = 0.0;   ///< standard error of ln Z
  double effective_draws = 0.0;  ///< effective posterior draws
  bool settled = false;          ///< true if the fixed-point iteration converged
};

/// Runs only the bridge-sampling iteration. `at_posterior` holds ln l = ln π - ln q at posterior
/// draws, one vector per chain, all of the same length. `at_proposal` holds ln l at draws of q. The
/// comment of the next function gives the formula.
[[nodiscard]] Bridge bridge(const ChainsOf& at_posterior, const std::vector<double>& at_proposal);

/// Bridge sampling with the optimal bridge of Meng & Wong (1996, Statistica Sinica 6:831). q is a
/// normal mixture fitted to the first half of each chain. With l = π/q at the posterior draws of
/// the second half (index 1) and at draws of q (index 2),
///
///   Z ← Σ₂ l / (s₁ l + s₂ Z) / n₂  ÷  Σ₁ 1 / (s₁ l + s₂ Z) / n₁
///
/// is iterated to its fixed point. s₁ and s₂ are the sizes of the two samples divided by their sum.
/// For the posterior draws, the effective sample size is used. The standard error follows from the
/// delta method with the autocorrelation of the posterior draws (Frühwirth-Schnatter 2004,
/// Econometrics Journal 7:143, section 3.2).
///
/// Throws std::invalid_argument for fewer than 20 draws per chain.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model,
                                       const ModelSamples& samples, const BridgeOptions& options);

/// Runs TMCMC as a pilot, then four chains of 5000 draws with the pilot as independence proposal,
/// and then bridge sampling. If bridge sampling gives a warning, the chains are repeated with four
/// and with sixteen times the length. If TMCMC fails, the result is NaN with the warning of TMCMC.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model,
                                       const BridgeOptions& options);

/// Runs bridge sampling like the previous function, but with a given pilot.
[[nodiscard]] Evidence bridge_sampling(const Problem& problem, int model, const Tmcmc& pilot,
                                       const BridgeOptions& options);

}  // namespace wheeltap::inference
