#include "inference/moves/delayed_rejection.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::inference {

Kernel::Outcome DelayedRejection::step(State& state, const Step& step) {
  constexpr double kImpossible = -std::numeric_limits<double>::infinity();
  auto& blocks = scales_[static_cast<std::size_t>(state.model)];
  if (blocks.empty()) return {};
  RandomWalk::Block& block = blocks.back();  // all coordinates
  const Eigen::Index d = block.factor.rows();
  Eigen::VectorXd u(d);
  const auto propose = [&](double scale, State& to) {
    to = state;
    for (double& value : u) value = step.random.normal();
    const Eigen::VectorXd shift = scale * (block.factor * u);
    for (Eigen::Index i = 0; i < d; ++i)
      to.z[static_cast<std::size_t>(block.first + i)] += shift[i];
    if (step.target.is_sorted(to)) {
      step.target.evaluate(to);
    } else {
      to.log_likelihood = kImpossible;
    }
  };
  const auto log_alpha = [&](const State& from, const State& to) {
    return std::min(0.0, log_target_ratio(step.target, step.beta, from, to));
  };

  propose(1.0, first_);
  const double log_alpha_1 = log_alpha(state, first_);
  Outcome outcome{.proposed = true, .accepted = false, .to_model = state.model};
  const double square_1 = u.squaredNorm();  // |S⁻¹ (z₁ - z)|²
  if (step.adapting) RandomWalk::learn(block, u, std::exp(log_alpha_1));
  if (std::log(step.random.uniform()) < log_alpha_1) {
    std::swap(state, first_);
    outcome.accepted = true;
    return outcome;
  }
  if (step.adapting) return outcome;  // the second stage would need S from before this step
  const Eigen::VectorXd u_first = u;
  propose(kShrink, second_);
  if (second_.log_likelihood == kImpossible) return outcome;
  const double log_alpha_back = log_alpha(second_, first_);
  if (log_alpha_back >= 0.0) return outcome;
  const double square_back = (u_first - kShrink * u).squaredNorm();  // |S⁻¹ (z₁ - z₂)|²
  const double log_ratio = log_target_ratio(step.target, step.beta, state, second_) -
                           0.5 * (square_back - square_1) + std::log1p(-std::exp(log_alpha_back)) -
                           std::log1p(-std::exp(log_alpha_1));
  if (std::log(step.random.uniform()) < log_ratio) {
    std::swap(state, second_);
    outcome.accepted = true;
  }
  return outcome;
}

}  // namespace wheeltap::inference
