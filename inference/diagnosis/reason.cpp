#include "inference/diagnosis/reason.hpp"

#include <cmath>

#include "base/readable.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {
namespace {

std::string plus_minus(const Estimate& x) {
  return base::readable(x.value, 3) +
         (std::isfinite(x.mcse) ? " ± " + base::readable(x.mcse, 1) : "");
}

std::string fixed_plus_minus(const Estimate& x) {
  return base::fixed(x.value, 2) + " ± " + base::fixed(x.mcse, 2);
}

std::string share_of(double share) {
  return base::readable(100.0 * share, 2) + " %";
}

// Text for a model without draws; a jump may have entered the model between two kept draws.
std::string jumps(long proposed) {
  return proposed > 0 ? "has no draws after " + base::grouped(proposed) + " proposals"
                      : "has no draws";
}

std::string implied(const Estimate& p) {
  return "; its evidence implies P ≈ " + plus_minus(p);
}

// Returns a sentence, or a clause for ChainsDisagree and TooFewEffectiveDraws.
struct VerdictSentence {
  const ModelSpace& space;

  [[nodiscard]] std::string quoted(int model) const { return "'" + space[model].name + "'"; }
  [[nodiscard]] std::string within(int model) const {
    return "Within model " + quoted(model) + " the ";
  }

  std::string operator()(const ModelNotEntered& r) const {
    return "Model " + quoted(r.model) + " " + jumps(r.proposed) + implied(r.by_evidence) + ".";
  }
  std::string operator()(const ModelNotInEveryChain& r) const {
    return "Only " + std::to_string(r.visited) + " of " + std::to_string(r.chains) +
           " chains have draws of model " + quoted(r.model) +
           (std::isnan(r.by_evidence.value) ? std::string() : implied(r.by_evidence)) + ".";
  }
  std::string operator()(const ModelUnknown& r) const {
    return "Model " + quoted(r.model) + " " + jumps(r.proposed) + "; its evidence is not known.";
  }
  std::string operator()(const ModeNotInEveryChain& r) const {
    return (r.visited == 0 ? std::string("No chain has")
                           : "Only " + std::to_string(r.visited) + " of " +
                                 std::to_string(r.chains) + " chains have") +
           " draws near a posterior mode of model " + quoted(r.model) +
           " that the searches found (about " + share_of(r.share) +
           " of that model's probability).";
  }
  std::string operator()(const ModeSharesDisagree& r) const {
    return "The chains disagree about a posterior mode of model " + quoted(r.model) +
           ": the fraction of the model's draws near this mode is " + share_of(r.lowest) + " to " +
           share_of(r.highest) + " (R-hat " + base::readable(r.rhat, 3) + ").";
  }
  std::string operator()(const AnnealingFindsMore& r) const {
    return "SMC finds more evidence for model " + quoted(r.model) +
           " (ln Z = " + fixed_plus_minus(r.annealed) + ") than its draws (" +
           fixed_plus_minus(r.drawn) + "): the draws may lack a posterior mode.";
  }
  std::string operator()(const EvidenceDisagrees& r) const {
    return "Model " + quoted(r.model) + " has P = " + plus_minus(r.by_draws) +
           " by its draws, but its evidence implies " + plus_minus(r.by_evidence) + ".";
  }
  std::string operator()(const DrawsBeyondMixture& r) const {
    return share_of(r.share) + " of the draws of model " + quoted(r.model) +
           " lie outside the support of the global proposals, in only " +
           base::readable(r.visits, 2) + " effectively independent visits (must exceed " +
           base::readable(r.limit, 3) + "): the chains may have missed a part of this region.";
  }
  std::string operator()(const AnnealingDrawsBeyond& r) const {
    return share_of(r.annealed) + " of the SMC draws of model " + quoted(r.model) +
           " lie in a region with only " + share_of(r.drawn) +
           " of the chain draws, and chains that start there do not leave it: the draws lack a "
           "part of the posterior.";
  }
  std::string operator()(const EvidenceUnreliable& r) const {
    return "The evidence of model " + quoted(r.model) +
           " is uncertain: the tail of its importance weights is too heavy (Pareto k " +
           base::readable(r.pareto, 2) + ", must be at most " + base::readable(r.limit, 2) +
           "), so that the estimate may be too small by a factor of " +
           base::readable(r.factor, 2) + implied(r.by_evidence) + ".";
  }
  std::string operator()(const ModesLeftOut& r) const {
    return "The search for posterior modes of model " + quoted(r.model) + " found " +
           std::to_string(r.modes) + (r.modes == 1 ? " mode" : " modes") +
           " more than it can keep (about " + share_of(r.share) + " of that model's probability).";
  }
  std::string operator()(const ChainsDisagree& r) const {
    return "R-hat of " + r.quantity + " is " + base::readable(r.rhat, 4) + " (must be below " +
           base::readable(r.limit, 4) + ")";
  }
  std::string operator()(const TooFewEffectiveDraws& r) const {
    return "the effective sample size of the " + r.quantity + " is " + base::readable(r.ess, 3) +
           " (must exceed " + base::readable(r.limit, 3) + ")";
  }
  std::string operator()(const ParameterDisagrees& r) const {
    return within(r.model) + "chains disagree about " + r.parameter + " (R-hat " +
           base::readable(r.rhat, 4) + ").";
  }
  std::string operator()(const ParameterMovesSlowly& r) const {
    return within(r.model) + "effective sample size of " + (r.tail ? "the tails of " : "") +
           r.parameter + " is " + base::readable(r.ess, 3) + " (must exceed " +
           base::readable(r.limit, 3) + ").";
  }
  std::string operator()(const TooFewRoundTrips& r) const {
    return "The tempered replicas completed only " + std::to_string(r.completed) +
           " round trips between prior and posterior (" + std::to_string(r.limit) + " are needed).";
  }
  std::string operator()(const StoppedEarly& /*unused*/) const { return "The run stopped early."; }
  std::string operator()(const QuickLook& /*unused*/) const {
    return "This is a quick run: posterior modes, their Laplace evidence and short chains, not a "
           "posterior.";
  }
};

}  // namespace

std::string describe(const Reason& reason, const ModelSpace& space) {
  return std::visit(VerdictSentence{space}, reason);
}

}  // namespace wheeltap::inference
