// Tests of user-defined priors and moves, to be called from the user's own test program. A test
// detects a faulty prior or move in seconds. In an MCMC run, such a fault would cause wrong results
// without any warning.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "inference/model/prior.hpp"
#include "inference/model/target.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

struct PriorCheck {
  /// One fault per entry, with the position; empty if no fault was found
  std::vector<std::string> faults;
  /// ∫ p(x) dx over the central interval that has the probability 1 - 2e-9. The density is
  /// normalised if this integral is within 1e-6 of 1.
  double mass = 0.0;
  [[nodiscard]] bool passed() const { return faults.empty(); }
};

/// Checks that density, distribution function and quantile function belong to one distribution. At
/// z from -6 to 6, three conditions must hold:
///
/// - x(z) increases within the support.
/// - z(x(z)) = z to the rounding of x.
/// - p(x(z)) dx/dz = φ(z) to 1e-5 by finite differences, except at density kinks and for steps
///   below the resolution of x.
///
/// If only the normalisation of the density is wrong, the fault states the integral of the density.
[[nodiscard]] PriorCheck check_prior(const Prior& prior);

struct MoveCheckOptions {
  std::uint64_t seed = 1;
  int draws = 20000;          ///< number of draws from the prior, with three likelihood evaluations
                              ///< each
  double false_alarm = 1e-6;  ///< probability that a correct move fails
};

struct MoveCheck {
  double p_value = 1.0;  ///< probability that a correct move gives a statistic at least as large
  bool passed = true;
  long proposed = 0, accepted = 0;
  long jumps_proposed = 0, jumps_accepted = 0;  ///< numbers of jumps between models
  double beta = 0.0;  ///< the largest exponent β of the likelihood used in the tests
  std::string words;  ///< the result in one sentence
};

/// Checks that a move satisfies detailed balance. States x are drawn from the prior, with
/// the weights w(x) = exp(ln prior factor + β ln likelihood). A state y is proposed from x, and
/// α(x, y) is the probability of accepting y (MetropolisHastings). The equation
///
///   E[w(x) α(x, y) (g(x) h(y) - h(x) g(y))] = 0
///
/// holds for all g and h if and only if the step is reversible with respect to prior ×
/// likelihood^β. The equation is tested for 64 pairs of bounded functions of model and z, some with
/// h = 1 (invariance), by normal tests with Bonferroni's correction (cf. Gandy & Scott 2020,
/// section 2, who test invariance). Half of the tests use β = 0. The other tests use the largest β
/// among 1, ½, ¼, … at which the effective sample size is at least a twentieth of the number of
/// draws. The test detects a wrong ratio, a wrong Jacobian, a ratio that omits the numbers of
/// possible choices, and a reverse move that does not lead back. A move that is never accepted
/// passes the test; `words` then states that detailed balance could not be tested. The approximate
/// likelihood of the problem is not used.
///
/// Throws std::invalid_argument for fewer than 100 draws, or if the problem's prior factor or
/// likelihood is not finite at any draw.
[[nodiscard]] MoveCheck check_move(const Problem& problem,
                                   const std::function<std::unique_ptr<Move>()>& make,
                                   const MoveCheckOptions& options = {});

}  // namespace wheeltap::inference
