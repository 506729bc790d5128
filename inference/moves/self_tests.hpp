// Tests for what a user adds to the engine: a prior, a move. They are run from a test of the
// user's own program, where a fault costs seconds; in a posterior it costs a wrong answer that
// looks like any other.
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
  std::vector<std::string> faults;  ///< one a line, with the place; empty where there is none
  /// ∫ p(x) dx over the middle 1 - 2e-9 of the distribution. Only within an error of 1e-6 is it
  /// one.
  double mass = 0.0;
  [[nodiscard]] bool passed() const { return faults.empty(); }
};

/// Whether density, distribution function and quantile are those of one distribution: at z from -6
/// to 6, x(z) increases within the support, z(x(z)) = z to what the rounding of x leaves, and
///
///   p(x(z)) dx/dz = φ(z)
///
/// to 1e-5 by differences, wherever x resolves them, kinks of the density apart. Where the density
/// alone is wrong by a constant, its mass is said.
[[nodiscard]] PriorCheck check_prior(const Prior& prior);

struct MoveCheckOptions {
  std::uint64_t seed = 1;
  int draws = 20000;          ///< from the prior; three likelihood calls each
  double false_alarm = 1e-6;  ///< how often a correct move may fail
};

struct MoveCheck {
  double p_value = 1.0;  ///< that of a correct move to look as bad as this one
  bool passed = true;
  long proposed = 0, accepted = 0;
  long jumps_proposed = 0, jumps_accepted = 0;  ///< those that change the model
  double beta = 0.0;  ///< the largest power of the likelihood that the draws could carry
  std::string words;  ///< all this in a sentence
};

/// Whether a move balances in detail. With states x from the prior, weights w(x) = exp(factor + β
/// log likelihood), y proposed from x, and α(x, y) the probability of accepting it
/// (MetropolisHastings),
///
///   E[w(x) α(x, y) (g(x) h(y) - h(x) g(y))] = 0
///
/// for any g and h if, and over all of them only if, the step is reversible with respect to
/// prior × likelihood^β. It is estimated for 64 pairs of bounded functions of model and z, some
/// with h = 1 (invariance), by normal tests with Bonferroni's correction (cf. Gandy & Scott 2020,
/// section 2, whose test is of invariance): half of them at β = 0, half at β halved from 1 until a
/// twentieth of the draws carries the weight. A wrong ratio, a wrong Jacobian, a forgotten
/// multiplicity of choices, a reverse move that does not lead back: all break it. A move that never
/// is accepted passes, and `words` says so. A stand-in of the problem is left out.
///
/// Throws std::invalid_argument where fewer than 100 draws are asked for, or the problem's prior
/// factor or likelihood is nowhere finite among the draws.
[[nodiscard]] MoveCheck check_move(const Problem& problem,
                                   const std::function<std::unique_ptr<Move>()>& make,
                                   const MoveCheckOptions& options = {});

}  // namespace wheeltap::inference
