#include "inference/stages/safe_points.hpp"

#include <algorithm>

#include "base/ranks.hpp"

namespace wheeltap::inference {

void SafePoints::pass(RunState& state) {
  if (!options_.save || !base::is_first_rank()) return;
  if (due()) {
    clock(state);
    return save(checkpoint_of(state));
  }
  if (Clock::now() < remembered_ + std::chrono::seconds(1)) return;
  clock(state);
  last_ = checkpoint_of(state);
  remembered_ = Clock::now();
}

void SafePoints::stop(RunState& state) {
  if (!options_.save || !base::is_first_rank()) return;
  clock(state);
  save(checkpoint_of(state));
}

void SafePoints::stopped() {
  if (last_) save(Checkpoint(std::move(*last_)));
}

void SafePoints::clock(RunState& state) {
  const auto now = Clock::now();
  state.posterior.wall_seconds += std::chrono::duration<double>(now - clocked_).count();
  clocked_ = now;
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
