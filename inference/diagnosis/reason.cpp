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

// Of a model in no draw: some jump may have entered it between two draws that were kept.
std::string jumps(long proposed) {
  return proposed > 0 ? "has no draws after " + base::grouped(proposed) + " proposals"
                      : "has no draws";
}

std::string implied(const Estimate& p) {
  return "; its evidence puts it at P ≈ " + plus_minus(p);
}

// A sentence, but of ChainsDisagree and TooFewEffectiveDraws a clause of one.
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
    return "Model " + quoted(r.model) + " was drawn by " + std::to_string(r.visited) + " of " +
           std::to_string(r.chains) + " chains only" +
           (std::isnan(r.by_evidence.value) ? std::string() : implied(r.by_evidence)) + ".";
  }
  std::string operator()(const ModelUnknown& r) const {
    return "Model " + quoted(r.model) + " " + jumps(r.proposed) +
           "; nothing is known of its evidence.";
  }
  std::string operator()(const ModeNotInEveryChain& r) const {
    return "A mode of model " + quoted(r.model) + " that the searches found, about " +
           share_of(r.share) + " of that model, is in the draws of " +
           (r.visited == 0
                ? std::string("no chain.")
                : std::to_string(r.visited) + " of " + std::to_string(r.chains) + " chains only.");
  }
  std::string operator()(const ModeSharesDisagree& r) const {
    return "The chains disagree about a mode of model " + quoted(r.model) + ": it has " +
           share_of(r.lowest) + " to " + share_of(r.highest) +
           " of their draws of that model (R-hat " + base::readable(r.rhat, 3) + ").";
  }
  std::string operator()(const AnnealingFindsMore& r) const {
    return "Annealing finds more evidence for model " + quoted(r.model) +
           " (ln Z = " + fixed_plus_minus(r.annealed) + ") than its draws have (" +
           fixed_plus_minus(r.drawn) + "): a mode may be missing from them.";
  }
  std::string operator()(const EvidenceDisagrees& r) const {
    return "Model " + quoted(r.model) + " has P = " + plus_minus(r.by_draws) +
           " by its draws, but its evidence implies " + plus_minus(r.by_evidence) + ".";
  }
  std::string operator()(const DrawsBeyondMixture& r) const {
    return "Of the draws of model " + quoted(r.model) + " " + share_of(r.share) +
           " lie where no proposal but small steps leads, in " + base::readable(r.visits, 2) +
           " effective visits (must exceed " + base::readable(r.limit, 3) +
           "): as much again may not have been found.";
  }
  std::string operator()(const AnnealingDrawsBeyond& r) const {
    return "Of model " + quoted(r.model) + " annealing drew " + share_of(r.annealed) +
           " where the chains have " + share_of(r.drawn) +
           " of their draws, and chains started there stay: a part of its posterior is missing "
           "from them.";
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
    return within(r.model) + "effective sample size of " + r.parameter + " is " +
           base::readable(r.ess, 3) + " (must exceed " + base::readable(r.limit, 3) + ").";
  }
  std::string operator()(const TooFewRoundTrips& r) const {
    return "The draws were tempered, but completed only " + std::to_string(r.completed) +
           " round trips between prior and posterior (" + std::to_string(r.limit) + " are needed).";
  }
  std::string operator()(const StoppedEarly& /*unused*/) const {
    return "The run was stopped early.";
  }
  std::string operator()(const QuickLook& /*unused*/) const {
    return "This is a quick look: modes, the evidence of normals about them and short chains; not "
           "a posterior.";
  }
};

}  // namespace

std::string describe(const Reason& reason, const ModelSpace& space) {
  return std::visit(VerdictSentence{space}, reason);
}

}  // namespace wheeltap::inference
