// Why a run may not be relied on: a type for each rule of the verdict (verdict.hpp), with the
// numbers that broke it and the limit that they broke. Words are made of them by who shows them.
#pragma once

#include <string>
#include <variant>

#include "inference/statistics/estimate.hpp"

namespace wheeltap::inference {

class ModelSpace;

/// A model that its evidence makes probable, and that no chain drew.
struct ModelNotEntered {
  int model = 0;
  long proposed = 0;       ///< jumps into it, after warm-up
  Estimate by_evidence{};  ///< its probability
};
/// One that some chains drew often and others never.
struct ModelNotInEveryChain {
  int model = 0;
  int visited = 0, chains = 0;
  Estimate by_evidence{};  ///< its probability; NaN where its evidence is not known
};
/// One of which there are neither draws nor evidence.
struct ModelUnknown {
  int model = 0;
  long proposed = 0;  ///< jumps into it, after warm-up
};
/// A mode that a search found, and that chains should have drawn.
struct ModeNotInEveryChain {
  int model = 0;
  double share = 0.0;  ///< of its model's probability
  int visited = 0, chains = 0;
};
/// The chains give a mode unlike shares of their draws of its model.
struct ModeSharesDisagree {
  int model = 0;
  double lowest = 0.0, highest = 0.0;
  double rhat = 0.0, limit = 0.0;
};
/// ln Z by annealing from the prior is above that of the draws: a mode may be missing from them.
struct AnnealingFindsMore {
  int model = 0;
  Estimate annealed{}, drawn{};  ///< ln Z
};
/// A model's share of the draws is not what the evidences imply.
struct EvidenceDisagrees {
  int model = 0;
  Estimate by_draws{}, by_evidence{};  ///< its probability
};
/// Many draws of a model lie where its mixture hardly is, in few visits: what a walk alone finds of
/// the posterior it may find half of.
struct DrawsBeyondMixture {
  int model = 0;
  double share = 0.0;                ///< of its draws
  double visits = 0.0, limit = 0.0;  ///< effective ones; must exceed it
};
/// Annealing's draws of a model are where neither its mixture is nor the chains were as often, and
/// chains that are started there stay.
struct AnnealingDrawsBeyond {
  int model = 0;
  double annealed = 0.0, drawn = 0.0;  ///< share of its draws there, by either
};
/// R-hat of something that means the same in every model.
struct ChainsDisagree {
  std::string quantity;  ///< "log posterior", "number of damages", "P(line)", or one that was given
  double rhat = 0.0, limit = 0.0;  ///< must be below it
};
/// Too few effective draws of something that means the same in every model.
struct TooFewEffectiveDraws {
  std::string quantity;           ///< "log posterior", "count", "model"
  double ess = 0.0, limit = 0.0;  ///< must exceed it
};
/// R-hat of a parameter within a model.
struct ParameterDisagrees {
  int model = 0;
  std::string parameter;  ///< of components of a kind, "sum of …": which is which is a label
  double rhat = 0.0, limit = 0.0;
};
/// Too few effective draws of a parameter within a model.
struct ParameterMovesSlowly {
  int model = 0;
  std::string parameter;
  double ess = 0.0, limit = 0.0;
};
/// Of replicas of the ladder that the draws were made with.
struct TooFewRoundTrips {
  long completed = 0, limit = 0;
};
struct StoppedEarly {};
/// Asked for as such (Options::quick): the chains are too short to be judged.
struct QuickLook {};

using Reason =
    std::variant<ModelNotEntered, ModelNotInEveryChain, ModelUnknown, ModeNotInEveryChain,
                 ModeSharesDisagree, AnnealingFindsMore, EvidenceDisagrees, DrawsBeyondMixture,
                 AnnealingDrawsBeyond, ChainsDisagree, TooFewEffectiveDraws, ParameterDisagrees,
                 ParameterMovesSlowly, TooFewRoundTrips, StoppedEarly, QuickLook>;

/// A sentence with the numbers of the reason; of ChainsDisagree and TooFewEffectiveDraws a clause
/// without a full stop. What to do about it depends on the caller (apps/text/verdict_words.hpp).
[[nodiscard]] std::string describe(const Reason& reason, const ModelSpace& space);

}  // namespace wheeltap::inference
