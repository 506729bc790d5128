#include "apps/text/verdict_words.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>

namespace wheeltap::apps {
namespace {

using namespace inference;

constexpr std::size_t kNamed = 4;  // largest number of models that a sentence names

const char* const kRunLonger = " Run longer (--warmup, --draws).";
const char* const kSearchMore =
    " Use more searches for posterior modes (--search) or longer chains (--warmup, --draws).";

// Advice on the options that help against a reason.
const char* advice(const Reason& reason) {
  if (std::holds_alternative<StoppedEarly>(reason)) return " Let the run continue to its end.";
  if (std::holds_alternative<QuickLook>(reason)) return " Run without --quick.";
  const bool search = std::holds_alternative<ModelNotEntered>(reason) ||
                      std::holds_alternative<AnnealingFindsMore>(reason) ||
                      std::holds_alternative<EvidenceUnreliable>(reason);
  return search ? kSearchMore : kRunLonger;
}

// Topics of reasons; consecutive reasons with one topic form one group of sentences.
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
                      std::is_same_v<R, AnnealingDrawsBeyond> ||
                      std::is_same_v<R, EvidenceUnreliable>)
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
        why += (why.empty() ? "" : ", ") + describe(reasons[i], space);
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
      out.push_back(describe(reasons[i], space) + advice(reasons[i]));
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
