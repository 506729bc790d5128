#include "inference/move.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wheeltap::inference {

double log_target_ratio(const Target& target, double beta, const State& from, const State& to) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // A state without finite likelihood is impossible at every temperature, beta = 0 included.
  if (to.log_likelihood == -kInfinity) return -kInfinity;
  if (from.log_likelihood == -kInfinity) return kInfinity;
  return beta * (to.log_likelihood - from.log_likelihood)  // likelihood ratio
         + target.log_prior(to) - target.log_prior(from);  // prior ratio
}

Kernel::Outcome MetropolisHastings::step(State& state, const Step& step) {
  proposal_ = state;
  proposal_.evaluated = false;
  const std::optional<double> log_hastings = move_->propose(state, step, proposal_);
  if (!log_hastings) return {};
  if (!proposal_.evaluated) step.target.evaluate(proposal_);
  const double log_ratio =
      log_target_ratio(step.target, step.beta, state, proposal_) + *log_hastings;
  Outcome outcome{.proposed = true, .accepted = false, .to_model = proposal_.model};
  // Strictly less, so that a ratio of zero (or NaN from ∞ - ∞) is never accepted.
  outcome.accepted = std::log(step.random.uniform()) < log_ratio;
  if (outcome.accepted) std::swap(state, proposal_);
  if (step.adapting) move_->adapt(std::exp(std::min(0.0, log_ratio)), state);
  return outcome;
}

void KernelMixture::add(double weight, std::unique_ptr<Kernel> kernel) {
  cumulative_.push_back((cumulative_.empty() ? 0.0 : cumulative_.back()) + weight);
  kernels_.push_back(std::move(kernel));
}

int KernelMixture::step(State& state, const Step& step, Kernel::Outcome& outcome) {
  if (kernels_.empty()) return -1;
  const double u = step.random.uniform() * cumulative_.back();
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  const auto chosen = static_cast<std::size_t>(found - cumulative_.begin());
  outcome = kernels_[chosen]->step(state, step);
  return static_cast<int>(chosen);
}

}  // namespace wheeltap::inference
