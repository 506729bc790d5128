#include "inference/engine/safe_points.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/ranks.hpp"

namespace wheeltap::inference {

void SafePoints::pass(RunState& state) {
  if (!options_.save || !base::is_first_rank()) return;
  if (due()) {
    clock(state);
    return save(rest_of(state));
  }
  if (Clock::now() < remembered_ + std::chrono::seconds(1)) return;
  clock(state);
  last_ = rest_of(state);
  remembered_ = Clock::now();
}

void SafePoints::stop(RunState& state) {
  if (!options_.save || !base::is_first_rank()) return;
  clock(state);
  save(rest_of(state));
}

void SafePoints::stopped() {
  if (last_) save(Checkpoint(std::move(*last_)));
}

void SafePoints::clock(RunState& state) {
  const auto now = Clock::now();
  state.posterior.wall_seconds += std::chrono::duration<double>(now - clocked_).count();
  clocked_ = now;
}

// A part belongs to one chain, because only a few chains draw at a time.
std::vector<std::size_t> SafePoints::hand_over_draws(RunState& state) const {
  if (!options_.save_draws) return {};
  const auto part = static_cast<std::size_t>(options_.part);
  const std::vector<Chain>& chains = state.posterior.chains;
  std::vector<std::size_t> kept(chains.size(), 0);
  for (const int c : state.at.part_chains) kept[static_cast<std::size_t>(c)] += part;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (kept[c] + part > chains[c].size()) continue;
    chains[c].settle();
    for (; kept[c] + part <= chains[c].size(); kept[c] += part) {
      const long number = state.at.first_part + static_cast<long>(state.at.part_chains.size());
      if (!options_.save_draws(draws_of(chains[c], kept[c], kept[c] + part), number)) return kept;
      state.at.part_chains.push_back(static_cast<int>(c));
    }
    chains[c].let_go();
  }
  return kept;
}

Checkpoint SafePoints::rest_of(RunState& state) const {
  std::vector<std::size_t> kept = hand_over_draws(state);
  return checkpoint_of(state, std::move(kept));
}

void SafePoints::save(const Checkpoint& checkpoint) {
  const auto began = Clock::now();
  options_.save(checkpoint);
  last_.reset();
  const auto now = Clock::now();
  const double took = std::chrono::duration<double>(now - began).count();
  const double every = options_.every_seconds;
  next_ = now + seconds(every > 0.0 ? std::max(every, took / kShare) : 0.0);
}

}  // namespace wheeltap::inference
