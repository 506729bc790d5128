#include "apps/text/verdict_words.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

namespace wheeltap::apps {
namespace {

using namespace inference;

constexpr std::size_t kNamed = 4;  // of many models alike

const char* const kRunLonger = " Run longer (--warmup, --draws).";
const char* const kSearchMore = " Search more (--search), or run longer (--warmup, --draws).";

std::string plus_minus(const inference::Estimate& x) {
  return significant(x.value, 3) + (std::isfinite(x.mcse) ? " ± " + significant(x.mcse, 1) : "");
}

std::string fixed_plus_minus(const inference::Estimate& x) {
  return fixed(x.value, 2) + " ± " + fixed(x.mcse, 2);
}

std::string share_of(double share) {
  return significant(100.0 * share, 2) + " %";
}

// Of a model in no draw: some jump may have entered it between two draws that were kept.
std::string jumps(long proposed) {
  return proposed > 0 ? "has no draws after " + grouped(proposed) + " proposals" : "has no draws";
}

std::string implied(const inference::Estimate& p) {
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
    return "Model " + quoted(r.model) + " " + jumps(r.proposed) + implied(r.by_evidence) + "." +
           kSearchMore;
  }
  std::string operator()(const ModelNotInEveryChain& r) const {
    return "Model " + quoted(r.model) + " was drawn by " + std::to_string(r.visited) + " of " +
           std::to_string(r.chains) + " chains only" +
           (std::isnan(r.by_evidence.value) ? std::string() : implied(r.by_evidence)) + "." +
           kRunLonger;
  }
  std::string operator()(const ModelUnknown& r) const {
    return "Model " + quoted(r.model) + " " + jumps(r.proposed) +
           "; nothing is known of its evidence." + kRunLonger;
  }
  std::string operator()(const ModeNotInEveryChain& r) const {
    return "A mode of model " + quoted(r.model) + " that the searches found, about " +
           share_of(r.share) + " of that model, is in the draws of " +
           (r.visited == 0
                ? std::string("no chain.")
                : std::to_string(r.visited) + " of " + std::to_string(r.chains) + " chains only.") +
           kRunLonger;
  }
  std::string operator()(const ModeSharesDisagree& r) const {
    return "The chains disagree about a mode of model " + quoted(r.model) + ": it has " +
           share_of(r.lowest) + " to " + share_of(r.highest) +
           " of their draws of that model (R-hat " + significant(r.rhat, 3) + ")." + kRunLonger;
  }
  std::string operator()(const AnnealingFindsMore& r) const {
    return "Annealing finds more evidence for model " + quoted(r.model) +
           " (ln Z = " + fixed_plus_minus(r.annealed) + ") than its draws have (" +
           fixed_plus_minus(r.drawn) + "): a mode may be missing from them." + kSearchMore;
  }
  std::string operator()(const EvidenceDisagrees& r) const {
    return "Model " + quoted(r.model) + " has P = " + plus_minus(r.by_draws) +
           " by its draws, but its evidence implies " + plus_minus(r.by_evidence) + "." +
           kRunLonger;
  }
  std::string operator()(const DrawsBeyondMixture& r) const {
    return "Of the draws of model " + quoted(r.model) + " " + share_of(r.share) +
           " lie where no proposal but small steps leads, in " + significant(r.visits, 2) +
           " effective visits (must exceed " + significant(r.limit, 3) +
           "): as much again may not have been found." + kRunLonger;
  }
  std::string operator()(const AnnealingDrawsBeyond& r) const {
    return "Of model " + quoted(r.model) + " annealing drew " + share_of(r.annealed) +
           " where the chains have " + share_of(r.drawn) +
           " of their draws, and chains started there stay: a part of its posterior is missing "
           "from them." +
           kRunLonger;
  }
  std::string operator()(const ChainsDisagree& r) const {
    return "R-hat of " + r.quantity + " is " + significant(r.rhat, 4) + " (must be below " +
           significant(r.limit, 4) + ")";
  }
  std::string operator()(const TooFewEffectiveDraws& r) const {
    return "the effective sample size of the " + r.quantity + " is " + significant(r.ess, 3) +
           " (must exceed " + significant(r.limit, 3) + ")";
  }
  std::string operator()(const ParameterDisagrees& r) const {
    return within(r.model) + "chains disagree about " + r.parameter + " (R-hat " +
           significant(r.rhat, 4) + ")." + kRunLonger;
  }
  std::string operator()(const ParameterMovesSlowly& r) const {
    return within(r.model) + "effective sample size of " + r.parameter + " is " +
           significant(r.ess, 3) + " (must exceed " + significant(r.limit, 3) + ")." + kRunLonger;
  }
  std::string operator()(const TooFewRoundTrips& r) const {
    return "The draws were tempered, but completed only " + std::to_string(r.completed) +
           " round trips between prior and posterior (" + std::to_string(r.limit) +
           " are needed)." + kRunLonger;
  }
  std::string operator()(const StoppedEarly& /*unused*/) const {
    return "The run was stopped early. Run it to its end.";
  }
  std::string operator()(const QuickLook& /*unused*/) const {
    return "This is a quick look: modes, the evidence of normals about them and short chains; not "
           "a posterior. Run without --quick.";
  }
};

// Reasons that follow each other and are told together.
enum class Topic { absent, partial, unknown, evidence, chains, parameters, alone };

Topic topic_of(const Reason& reason) {
  return std::visit(
      [](const auto& r) {
        using R = std::decay_t<decltype(r)>;
        if constexpr (std::is_same_v<R, ModelNotEntered>) return Topic::absent;
        if constexpr (std::is_same_v<R, ModelNotInEveryChain>) return Topic::partial;
        if constexpr (std::is_same_v<R, ModelUnknown>) return Topic::unknown;
        if constexpr (std::is_same_v<R, AnnealingFindsMore> ||
                      std::is_same_v<R, EvidenceDisagrees> ||
                      std::is_same_v<R, DrawsBeyondMixture> ||
                      std::is_same_v<R, AnnealingDrawsBeyond>)
          return Topic::evidence;
        if constexpr (std::is_same_v<R, ChainsDisagree> || std::is_same_v<R, TooFewEffectiveDraws>)
          return Topic::chains;
        if constexpr (std::is_same_v<R, ParameterDisagrees> ||
                      std::is_same_v<R, ParameterMovesSlowly>)
          return Topic::parameters;
        return Topic::alone;
      },
      reason);
}

}  // namespace

std::vector<std::string> in_words(const std::vector<Reason>& reasons, const ModelSpace& space) {
  std::vector<std::string> out;
  for (std::size_t begin = 0, end = 0; begin < reasons.size(); begin = end) {
    const Topic topic = topic_of(reasons[begin]);
    while (end < reasons.size() && topic_of(reasons[end]) == topic) ++end;
    if (topic == Topic::chains) {
      std::string why;
      for (std::size_t i = begin; i < end; ++i) {
        why += (why.empty() ? "" : ", ") + std::visit(VerdictSentence{space}, reasons[i]);
      }
      out.push_back("The chains have not converged: " + why + ". Do not trust these numbers yet." +
                    kRunLonger);
      continue;
    }
    const std::size_t all = end - begin;
    const std::size_t named = topic == Topic::alone      ? all
                              : topic == Topic::evidence ? std::min(all, 2 * kNamed)
                                                         : std::min(all, kNamed);
    for (std::size_t i = begin; i < begin + named; ++i) {
      out.push_back(std::visit(VerdictSentence{space}, reasons[i]));
    }
    if (named < all && topic != Topic::evidence) {
      out.push_back("The same holds for " +
                    std::string(topic == Topic::parameters ? "parameters of " : "") +
                    std::to_string(all - named) + " more models.");
    }
  }
  return out;
}

}  // namespace wheeltap::apps
