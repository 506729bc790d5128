#include "inference/moves/move.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/constants.hpp"

namespace wheeltap::inference {

namespace {

constexpr double kSmallestLogAlpha = -7.0;  ///< lower limit of log α in adaptation: α = 1e-3

double log_ratio(const Target& target, double beta, const State& from, const State& to,
                 double State::*log_likelihood) {
  // A state without a finite likelihood is impossible at every temperature, even at beta = 0.
  if (to.*log_likelihood == -kInfinity) return -kInfinity;
  if (from.*log_likelihood == -kInfinity) return kInfinity;
  return beta * (to.*log_likelihood - from.*log_likelihood)  // likelihood ratio
         + target.log_prior(to) - target.log_prior(from);    // prior ratio
}

}  // namespace

double log_target_ratio(const Target& target, double beta, const State& from, const State& to) {
  return log_ratio(target, beta, from, to, &State::log_likelihood);
}

double log_screen_ratio(const Target& target, double beta, const State& from, const State& to) {
  return log_ratio(target, beta, from, to, &State::log_screen);
}

Kernel::Outcome MetropolisHastings::step(State& state, const Step& step) {
  proposal_ = state;
  proposal_.screened = proposal_.evaluated = false;
  const std::optional<double> log_hastings = move_->propose(state, step, proposal_);
  if (!log_hastings) return {};
  const double log_u = std::log(step.random.uniform());
  if (!proposal_.screened) {
    // A proposal with a lower value of beta · log_screen + log_prior is rejected.
    const double level = (step.adapting ? std::min(log_u, kSmallestLogAlpha) : log_u) -
                         *log_hastings + step.beta * state.log_screen +
                         step.target.log_prior(state);
    step.target.screen_above(level, step.beta, proposal_);
  }
  const double log_first =
      log_screen_ratio(step.target, step.beta, state, proposal_) + *log_hastings;
  Outcome outcome{.proposed = true, .accepted = false, .to_model = proposal_.model};
  // "Less" instead of "less or equal": a ratio of zero (or NaN from ∞ - ∞) is never accepted.
  outcome.accepted = log_u < log_first;
  double log_second = 0.0;
  if (outcome.accepted && step.target.has_screen()) {
    step.target.complete(proposal_);
    log_second = step.beta * (proposal_.log_likelihood - proposal_.log_screen -
                              state.log_likelihood + state.log_screen);
    // A state with zero likelihood is impossible, even for beta = 0.
    if (!std::isfinite(proposal_.log_likelihood)) log_second = proposal_.log_likelihood;
    outcome.accepted = std::log(step.random.uniform()) < log_second;
  }
  if (outcome.accepted) std::swap(state, proposal_);
  if (step.adapting) {
    move_->adapt(std::exp(std::min(0.0, log_first) + std::min(0.0, log_second)), state);
  }
  return outcome;
}

void KernelMixture::add(double weight, std::unique_ptr<Kernel> kernel, double most) {
  most_.push_back(most);
  cumulative_.push_back((cumulative_.empty() ? 0.0 : cumulative_.back()) + weight);
  kernels_.push_back(std::move(kernel));
}

void KernelMixture::reweigh(const std::vector<double>& factors) {
  double before = 0.0, running = 0.0;
  for (std::size_t k = 0; k < cumulative_.size(); ++k) {
    const double weight = cumulative_[k] - before;
    before = cumulative_[k];
    cumulative_[k] = running += weight * factors[k];
  }
}

std::vector<double> kernel_efficiencies(const KernelMixture& kernels,
                                        const std::vector<KernelRecord>& records) {
  constexpr long kEnough = 100;  // smallest number of proposals
  constexpr double kLeast = 0.1;
  const auto jumps = [&](std::size_t k) { return records[k].jumps_proposed > 0; };
  std::vector<double> rate(records.size(), -1.0);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const KernelRecord& r = records[k];
    if (r.proposed < kEnough) continue;
    const double work =
        static_cast<double>(r.proposed) * (1.0 + kernels[static_cast<int>(k)].work());
    rate[k] = static_cast<double>(jumps(k) ? r.jumps_accepted : r.accepted) / work;
  }
  std::vector<double> efficiency(records.size(), 1.0);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const double most = kernels.most(static_cast<int>(k));
    if (rate[k] < 0.0 || (kernels[static_cast<int>(k)].work() == 0.0 && most == 1.0)) continue;
    double best = 0.0;
    for (std::size_t other = 0; other < records.size(); ++other)
      if (other != k && jumps(other) == jumps(k)) best = std::max(best, rate[other]);
    if (best > 0.0) efficiency[k] = std::clamp(rate[k] / best, kLeast, most);
  }
  return efficiency;
}

std::vector<double> KernelMixture::learnt() const {
  std::vector<double> numbers;
  for (const auto& kernel : kernels_) kernel->save(numbers);
  return numbers;
}

void KernelMixture::restore(std::span<const double> learnt) {
  const std::size_t wanted = this->learnt().size();
  if (learnt.size() != wanted) {
    throw std::invalid_argument("kernels: " + std::to_string(learnt.size()) +
                                " saved numbers, must be " + std::to_string(wanted));
  }
  for (const auto& kernel : kernels_) kernel->restore(learnt);
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
