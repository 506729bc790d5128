#include "inference/moves/slice.hpp"

#include <cmath>

namespace wheeltap::inference {

Kernel::Outcome Slice::step(State& state, const Step& step) {
  constexpr int kMostSteps = 30;  // largest number of extensions, for both ends together
  if (state.z.empty()) return {};
  base::Random& random = step.random;
  // The direction is that of one coordinate, or a random direction in all coordinates.
  direction_.assign(state.z.size(), 0.0);
  const double length = width_ * std::exp(random.normal());
  if (random.uniform() < 0.5) {
    direction_[static_cast<std::size_t>(random.index(static_cast<int>(state.z.size())))] = length;
  } else {
    for (double& d : direction_) d = length * random.normal();
  }
  const auto log_ratio_at = [&](double t) {
    trial_ = state;
    for (std::size_t i = 0; i < direction_.size(); ++i) trial_.z[i] += t * direction_[i];
    // The target density is zero for vectors that are not in order.
    if (!step.target.is_sorted(trial_)) return -std::numeric_limits<double>::infinity();
    step.target.evaluate(trial_);
    return log_target_ratio(step.target, step.beta, state, trial_);
  };
  const double level = -random.exponential();  // ln y - ln π(z)
  double left = -random.uniform();
  double right = left + 1.0;
  int left_steps = random.index(kMostSteps);
  int right_steps = kMostSteps - 1 - left_steps;
  while (left_steps-- > 0 && log_ratio_at(left) > level) left -= 1.0;
  while (right_steps-- > 0 && log_ratio_at(right) > level) right += 1.0;
  while (true) {
    const double t = left + random.uniform() * (right - left);
    if (log_ratio_at(t) > level) break;
    (t < 0.0 ? left : right) = t;
    if (right - left < 1e-14) return {.proposed = true, .accepted = false, .to_model = state.model};
  }
  std::swap(state, trial_);
  return {.proposed = true, .accepted = true, .to_model = state.model};
}

}  // namespace wheeltap::inference
