#include "identification/sid/findings/chain_modes.hpp"

#include <algorithm>
#include <optional>

#include "dynamics/linear_modes.hpp"

namespace wheeltap::identification {

std::vector<ChainMode> chain_modes(const SidProblem& problem, const inference::Posterior& posterior,
                                   int model) {
  constexpr std::size_t kMostDraws = 500;
  const dynamics::Chain& chain = problem.sid_case.models[static_cast<std::size_t>(model)].chain;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<std::vector<std::vector<dynamics::LinearMode>>> modes;  // chain, draw, mode
  std::optional<std::size_t> count;                                   // of modes in each draw
  for (const inference::Chain& c : posterior.chains) {
    std::vector<std::size_t> at;
    for (std::size_t i = 0; i < c.model.size(); ++i) {
      if (c.model[i] == model) at.push_back(i);
    }
    modes.emplace_back();
    const std::size_t n = std::min(at.size(), kMostDraws);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t i = at[j * at.size() / n];
      modes.back().push_back(
          dynamics::linear_modes(chain, problem.theta(model, {&c.theta[i * width], width})));
      if (!count) count = modes.back().back().size();
      if (modes.back().back().size() != *count) return {};
    }
  }
  std::vector<ChainMode> out;
  for (std::size_t mode = 0; mode < count.value_or(0); ++mode) {
    inference::ChainsOf frequency, damping;
    for (const auto& draws : modes) {
      frequency.emplace_back();
      damping.emplace_back();
      for (const auto& draw : draws) {
        frequency.back().push_back(draw[mode].frequency_hz);
        damping.back().push_back(draw[mode].damping_ratio);
      }
    }
    out.push_back({.frequency_hz = marginal(frequency), .damping_ratio = marginal(damping)});
  }
  return out;
}

}  // namespace wheeltap::identification
