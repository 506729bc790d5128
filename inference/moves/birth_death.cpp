#include "inference/moves/birth_death.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace wheeltap::inference {

namespace {

double log_standard_normal(std::span<const double> z) {
  double sum = 0.0;
  for (const double value : z) sum -= 0.5 * (value * value + std::log(2.0 * std::numbers::pi));
  return sum;
}

// Where in order a component with this first coordinate goes, among those of its kind.
int slot_of(const State& state, const Model& model, int kind, std::size_t width, double first) {
  const auto j = static_cast<std::size_t>(kind);
  int slot = 0;
  while (
      slot < model.counts[j] &&
      state.z[static_cast<std::size_t>(model.offsets[j]) + static_cast<std::size_t>(slot) * width] <
          first) {
    ++slot;
  }
  return slot;
}

}  // namespace

void BirthDeath::choose_deaths(const ModelSpace& space, int larger, const std::vector<double>& z) {
  const auto j = static_cast<std::size_t>(kind_);
  const auto k = static_cast<std::size_t>(space[larger].counts[j]);
  probability_.assign(k, 1.0 / static_cast<double>(k));
  if (!pilot_ || k == 1) return;
  const std::size_t width = space.kinds()[j].parameters.size();
  const auto offset = static_cast<std::size_t>(space[larger].offsets[j]);
  const int smaller = space.neighbour(larger, kind_, -1);
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < k; ++i) {
    // The set without i, from the set without i - 1.
    if (i == 0) {
      rest_ = z;
      rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(offset),
                  rest_.begin() + static_cast<std::ptrdiff_t>(offset + width));
    } else {
      const std::size_t at = offset + (i - 1) * width;
      std::copy_n(z.begin() + static_cast<std::ptrdiff_t>(at), width,
                  rest_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    probability_[i] = pilot_->log_density(smaller, rest_);
    top = std::max(top, probability_[i]);
  }
  const double uniform = 1.0 / static_cast<double>(k);
  double sum = 0.0;
  for (double& p : probability_) sum += p = std::exp(p - top);
  for (double& p : probability_) {
    p = sum > 0.0 ? kDefensive * uniform + (1.0 - kDefensive) * p / sum : uniform;
  }
}

std::optional<double> BirthDeath::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const auto j = static_cast<std::size_t>(kind_);
  const std::size_t width = space.kinds()[j].parameters.size();
  const bool birth = step.random.uniform() < 0.5;
  const int model = space.neighbour(from.model, kind_, birth ? +1 : -1);
  if (model < 0) return std::nullopt;
  to.model = model;
  const auto offset = static_cast<std::size_t>(space[from.model].offsets[j]);
  component_.resize(width);
  // ln [death's choice of c] - ln q(c), of the birth that leads to the larger set.
  const auto log_birth_ratio = [&](std::size_t slot) {
    return std::log(probability_[slot]) - log_standard_normal(component_) -
           proposal_->log_density_ratio(component_);
  };

  if (birth) {
    proposal_->condition(from, kind_, -1, step.beta);
    proposal_->draw(step.random, component_);
    const auto slot =
        static_cast<std::size_t>(slot_of(from, space[from.model], kind_, width, component_[0]));
    to.z.insert(to.z.begin() + static_cast<std::ptrdiff_t>(offset + slot * width),
                component_.begin(), component_.end());
    choose_deaths(space, model, to.z);
    return log_birth_ratio(slot);
  }
  choose_deaths(space, from.model, from.z);
  double u = step.random.uniform();
  std::size_t slot = 0;
  for (; slot + 1 < probability_.size(); ++slot) {
    u -= probability_[slot];
    if (u < 0.0) break;
  }
  const auto at = from.z.begin() + static_cast<std::ptrdiff_t>(offset + slot * width);
  std::copy_n(at, width, component_.begin());
  const auto gap = to.z.begin() + static_cast<std::ptrdiff_t>(offset + slot * width);
  to.z.erase(gap, gap + static_cast<std::ptrdiff_t>(width));
  // The reverse birth starts from the smaller set, whose residual has to be known.
  step.target.screen(to);
  proposal_->condition(to, kind_, -1, step.beta);
  return -log_birth_ratio(slot);
}

std::optional<double> Relocation::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const auto j = static_cast<std::size_t>(kind_);
  const std::size_t width = space.kinds()[j].parameters.size();
  const int k = space[from.model].counts[j];
  if (k == 0) return std::nullopt;
  const auto offset = static_cast<std::size_t>(space[from.model].offsets[j]);
  const int old_slot = step.random.index(k);
  const auto old_at =
      static_cast<std::ptrdiff_t>(offset + static_cast<std::size_t>(old_slot) * width);
  const std::vector<double> old_component(
      from.z.begin() + old_at, from.z.begin() + old_at + static_cast<std::ptrdiff_t>(width));

  std::vector<double> component(width);
  proposal_->condition(from, kind_, old_slot, step.beta);
  proposal_->draw(step.random, component);
  const double log_forward =
      log_standard_normal(component) + proposal_->log_density_ratio(component);

  std::copy(component.begin(), component.end(), to.z.begin() + old_at);
  step.target.sort_components(to);
  step.target.screen(to);
  int slot = 0;
  while (!std::equal(component.begin(), component.end(),
                     to.z.begin() + static_cast<std::ptrdiff_t>(offset) +
                         slot * static_cast<std::ptrdiff_t>(width))) {
    ++slot;
  }
  proposal_->condition(to, kind_, slot, step.beta);
  return log_standard_normal(old_component) + proposal_->log_density_ratio(old_component) -
         log_forward;
}

}  // namespace wheeltap::inference
