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

double BirthDeath::log_birth_ratio(int k_larger, std::span<const double> component) const {
  return -std::log(static_cast<double>(k_larger))  // death: one of the k + 1
         - log_standard_normal(component) - proposal_->log_density_ratio(component);
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

  if (birth) {
    std::vector<double> component(width);
    proposal_->condition(from, kind_, -1, step.beta);
    proposal_->draw(step.random, component);
    const int slot = slot_of(from, space[from.model], kind_, width, component[0]);
    const auto at = static_cast<std::ptrdiff_t>(offset + static_cast<std::size_t>(slot) * width);
    to.z.insert(to.z.begin() + at, component.begin(), component.end());
    return log_birth_ratio(space[model].counts[j], component);
  }
  const int k = space[from.model].counts[j];
  const auto at =
      static_cast<std::ptrdiff_t>(offset + static_cast<std::size_t>(step.random.index(k)) * width);
  const std::vector<double> component(from.z.begin() + at,
                                      from.z.begin() + at + static_cast<std::ptrdiff_t>(width));
  to.z.erase(to.z.begin() + at, to.z.begin() + at + static_cast<std::ptrdiff_t>(width));
  // The reverse birth starts from the smaller set, whose residual has to be known.
  step.target.screen(to);
  proposal_->condition(to, kind_, -1, step.beta);
  return -log_birth_ratio(k, component);
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
