// Reasons why a run has not converged: one type for each convergence rule (verdict.hpp), with the
// values and the limit. The caller converts a reason to a message.
#pragma once

#include <string>
#include <variant>

#include "inference/statistics/estimate.hpp"

namespace wheeltap::inference {

class ModelSpace;

/// A model has a considerable probability according to its evidence, but no draws.
struct ModelNotEntered {
  int model = 0;
  long proposed = 0;       ///< proposed jumps into the model after warm-up
  Estimate by_evidence{};  ///< model probability computed from its evidence
};
/// A model has many draws in some chains and no draws in others.
struct ModelNotInEveryChain {
  int model = 0;
  int visited = 0, chains = 0;
  Estimate by_evidence{};  ///< model probability by evidence; NaN if unknown
};
/// A model with neither draws nor evidence.
struct ModelUnknown {
  int model = 0;
  long proposed = 0;  ///< proposed jumps into the model after warm-up
};
/// A Markov chain has no draws near a posterior mode that the mode search found and the chain
/// should have visited.
struct ModeNotInEveryChain {
  int model = 0;
  double share = 0.0;  ///< fraction of the model's probability mass near this posterior mode
  int visited = 0, chains = 0;
};
/// The chains disagree on the fraction of a model's draws that lie near a posterior mode.
struct ModeSharesDisagree {
  int model = 0;
  double lowest = 0.0, highest = 0.0;
  double rhat = 0.0, limit = 0.0;
};
/// ln Z by SMC from the prior exceeds ln Z from the draws, so the draws may miss a posterior mode.
struct AnnealingFindsMore {
  int model = 0;
  Estimate annealed{}, drawn{};  ///< ln Z by SMC, and by the draws
};
/// The fraction of draws in a model differs from the model probability given by the evidence.
struct EvidenceDisagrees {
  int model = 0;
  Estimate by_draws{}, by_evidence{};  ///< model probability by draws, and by evidence
};
/// Many draws of a model lie outside its fitted mixture, but the chains made only few independent
/// visits to this region. Only local moves reach the region outside the mixture, so the chains may
/// have missed a part of this region.
struct DrawsBeyondMixture {
  int model = 0;
  double share = 0.0;                ///< fraction of the model's draws outside its mixture
  double visits = 0.0, limit = 0.0;  ///< effective visits outside the mixture; must exceed `limit`
};
/// The fraction of SMC draws outside a model's mixture is larger than the fraction of chain draws
/// outside it. Chains that start at these SMC draws do not move into the mixture, so the posterior
/// has probability mass outside the mixture.
struct AnnealingDrawsBeyond {
  int model = 0;
  /// Fractions of the SMC draws and of the chain draws that lie outside the mixture.
  double annealed = 0.0, drawn = 0.0;
};
/// The importance weights of a model's evidence have a heavy tail: with more draws, the evidence
/// may become far larger. The model's draws do not confirm the evidence.
struct EvidenceUnreliable {
  int model = 0;
  double pareto = 0.0, limit = 0.0;  ///< Pareto shape k̂ of the weights; must not exceed `limit`
  Estimate by_evidence{};            ///< model probability by evidence
  double factor = 1.0;               ///< factor by which the evidence may be too small
};
/// A search found more separate posterior modes than it can keep.
struct ModesLeftOut {
  int model = 0;
  long modes = 0;      ///< number of posterior modes that were left out
  double share = 0.0;  ///< fraction of the probability mass at these modes (Laplace)
};
/// R-hat is too large for a quantity that has the same meaning in every model.
struct ChainsDisagree {
  std::string quantity;  ///< "log posterior", "number of damages", "P(line)", or a watched quantity
  double rhat = 0.0, limit = 0.0;  ///< R-hat, which must be below `limit`
};
/// Too few effective draws of a quantity that has the same meaning in every model.
struct TooFewEffectiveDraws {
  std::string quantity;           ///< "log posterior", "count", "model"
  double ess = 0.0, limit = 0.0;  ///< effective sample size, which must exceed `limit`
};
/// R-hat of a parameter within a model is too large.
struct ParameterDisagrees {
  int model = 0;
  /// Name of the parameter. For components of a kind, the name is "sum of …", because the component
  /// numbers are arbitrary labels.
  std::string parameter;
  double rhat = 0.0, limit = 0.0;
};
/// Too few effective draws of a parameter within a model.
struct ParameterMovesSlowly {
  int model = 0;
  std::string parameter;
  double ess = 0.0, limit = 0.0;
  bool tail = false;  ///< true: too few effective draws for its 5 % and 95 % quantiles
};
/// Too few round trips of replicas on the temperature ladder with which the draws were made.
struct TooFewRoundTrips {
  long completed = 0, limit = 0;
};
struct StoppedEarly {};
/// A quick run (Options::quick): its chains are too short to be judged.
struct QuickLook {};

using Reason =
    std::variant<ModelNotEntered, ModelNotInEveryChain, ModelUnknown, ModeNotInEveryChain,
                 ModeSharesDisagree, AnnealingFindsMore, EvidenceDisagrees, DrawsBeyondMixture,
                 AnnealingDrawsBeyond, EvidenceUnreliable, ModesLeftOut, ChainsDisagree,
                 TooFewEffectiveDraws, ParameterDisagrees, ParameterMovesSlowly, TooFewRoundTrips,
                 StoppedEarly, QuickLook>;

/// Returns a sentence that states the reason and its values. For ChainsDisagree and
/// TooFewEffectiveDraws, the result is a clause without a full stop. The caller adds the advice
/// (apps/text/verdict_words.hpp).
[[nodiscard]] std::string describe(const Reason& reason, const ModelSpace& space);

}  // namespace wheeltap::inference
