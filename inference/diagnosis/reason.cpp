#include "inference/diagnosis/reason.hpp"

#include <cstdio>

#include "inference/model/model_space.hpp"

namespace wheeltap::inference {
namespace {

std::string short_number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string of(int count, int all) {
  return std::to_string(count) + " of " + std::to_string(all);
}

struct Phrase {
  const ModelSpace& space;

  [[nodiscard]] std::string name(int model) const { return "model '" + space[model].name + "'"; }

  std::string operator()(const ModelNotEntered& r) const {
    return name(r.model) + ": drawn by no chain, probability by evidence " +
           short_number(r.by_evidence.value);
  }
  std::string operator()(const ModelNotInEveryChain& r) const {
    return name(r.model) + ": drawn by " + of(r.visited, r.chains) + " chains";
  }
  std::string operator()(const ModelUnknown& r) const {
    return name(r.model) + ": neither draws nor evidence";
  }
  std::string operator()(const ModeNotInEveryChain& r) const {
    return name(r.model) + ": a mode of share " + short_number(r.share) + " drawn by " +
           of(r.visited, r.chains) + " chains";
  }
  std::string operator()(const ModeSharesDisagree& r) const {
    return name(r.model) + ": R-hat of a mode's share " + short_number(r.rhat) +
           " >= " + short_number(r.limit);
  }
  std::string operator()(const AnnealingFindsMore& r) const {
    return name(r.model) + ": ln Z by SMC " + short_number(r.annealed.value) + ", by draws " +
           short_number(r.drawn.value);
  }
  std::string operator()(const EvidenceDisagrees& r) const {
    return name(r.model) + ": probability by draws " + short_number(r.by_draws.value) +
           ", by evidence " + short_number(r.by_evidence.value);
  }
  std::string operator()(const DrawsBeyondMixture& r) const {
    return name(r.model) + ": share of draws outside its mixture " + short_number(r.share) +
           ", effective visits " + short_number(r.visits) + " <= " + short_number(r.limit);
  }
  std::string operator()(const AnnealingDrawsBeyond& r) const {
    return name(r.model) + ": share of SMC draws outside its mixture " + short_number(r.annealed) +
           ", of chain draws " + short_number(r.drawn);
  }
  std::string operator()(const ChainsDisagree& r) const {
    return "R-hat of " + r.quantity + " " + short_number(r.rhat) + " >= " + short_number(r.limit);
  }
  std::string operator()(const TooFewEffectiveDraws& r) const {
    return "effective draws of the " + r.quantity + " " + short_number(r.ess) +
           " <= " + short_number(r.limit);
  }
  std::string operator()(const ParameterDisagrees& r) const {
    return name(r.model) + ": R-hat of " + r.parameter + " " + short_number(r.rhat) +
           " >= " + short_number(r.limit);
  }
  std::string operator()(const ParameterMovesSlowly& r) const {
    return name(r.model) + ": effective draws of " + r.parameter + " " + short_number(r.ess) +
           " <= " + short_number(r.limit);
  }
  std::string operator()(const TooFewRoundTrips& r) const {
    return "round trips of the ladder " + std::to_string(r.completed) + " < " +
           std::to_string(r.limit);
  }
  std::string operator()(const StoppedEarly& /*unused*/) const { return "stopped early"; }
  std::string operator()(const QuickLook& /*unused*/) const { return "quick run"; }
};

}  // namespace

std::string describe(const Reason& reason, const ModelSpace& space) {
  return std::visit(Phrase{space}, reason);
}

}  // namespace wheeltap::inference
