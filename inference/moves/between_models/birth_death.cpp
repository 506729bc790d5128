#include "inference/moves/between_models/birth_death.hpp"

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

// The index of a component with this first coordinate in the order of its kind.
int index_in_order(const State& state, const ModelSpace& space, int kind, double first) {
  const int count = space[state.model].counts[static_cast<std::size_t>(kind)];
  int c = 0;
  while (c < count && state.z[space.component(state.model, kind, c).first] < first) ++c;
  return c;
}

std::vector<double>::difference_type place(std::size_t i) {
  return static_cast<std::vector<double>::difference_type>(i);
}

}  // namespace

void BirthDeath::choose_deaths(const ModelSpace& space, int larger, const std::vector<double>& z) {
  const auto j = static_cast<std::size_t>(kind_);
  const auto k = static_cast<std::size_t>(space[larger].counts[j]);
  probability_.assign(k, 1.0 / static_cast<double>(k));
  if (!pilot_ || k == 1) return;
  const int smaller = space.neighbour(larger, kind_, -1);
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < k; ++i) {
    // Changes the set without i - 1 to the set without i.
    if (i == 0) {
      const ComponentRange first = space.component(larger, kind_, 0);
      rest_ = z;
      rest_.erase(rest_.begin() + place(first.first),
                  rest_.begin() + place(first.first + first.width));
    } else {
      const ComponentRange before = space.component(larger, kind_, static_cast<int>(i) - 1);
      std::ranges::copy(before.of(z), rest_.begin() + place(before.first));
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
  const bool birth = step.random.uniform() < 0.5;
  const int model = space.neighbour(from.model, kind_, birth ? +1 : -1);
  if (model < 0) return std::nullopt;
  to.model = model;
  component_.resize(space.width(kind_));
  // ln [probability that a death removes c] - ln q(c), for the birth of c.
  const auto log_birth_ratio = [&](int c) {
    return std::log(probability_[static_cast<std::size_t>(c)]) - log_standard_normal(component_) -
           proposal_->log_density_ratio(component_);
  };

  if (birth) {
    proposal_->condition(from, kind_, -1, step.beta);
    proposal_->draw(step.random, component_);
    const int born = index_in_order(from, space, kind_, component_[0]);
    to.z.insert(to.z.begin() + place(space.component(from.model, kind_, born).first),
                component_.begin(), component_.end());
    choose_deaths(space, model, to.z);
    return log_birth_ratio(born);
  }
  choose_deaths(space, from.model, from.z);
  double u = step.random.uniform();
  int dying = 0;
  for (; dying + 1 < static_cast<int>(probability_.size()); ++dying) {
    u -= probability_[static_cast<std::size_t>(dying)];
    if (u < 0.0) break;
  }
  const ComponentRange at = space.component(from.model, kind_, dying);
  std::ranges::copy(at.of(from.z), component_.begin());
  const auto gap = to.z.begin() + place(at.first);
  to.z.erase(gap, gap + place(at.width));
  // The reverse birth starts from the smaller set and uses its residual.
  step.target.screen(to);
  proposal_->condition(to, kind_, -1, step.beta);
  return -log_birth_ratio(dying);
}

std::optional<double> Relocation::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const int k = space[from.model].counts[static_cast<std::size_t>(kind_)];
  if (k == 0) return std::nullopt;
  const int taken = step.random.index(k);
  const ComponentRange at = space.component(from.model, kind_, taken);
  const std::span<const double> old_component = at.of(from.z);

  std::vector<double> component(old_component.begin(), old_component.end());
  proposal_->condition(from, kind_, taken, step.beta);
  proposal_->draw(step.random, component);
  const double log_forward =
      log_standard_normal(component) + proposal_->log_density_ratio(component);

  std::ranges::copy(component, at.of(to.z).begin());
  step.target.sort_components(to);
  step.target.screen(to);
  int put = 0;
  while (!std::ranges::equal(component, space.component(to.model, kind_, put).of(to.z))) ++put;
  proposal_->condition(to, kind_, put, step.beta);
  return log_standard_normal(old_component) + proposal_->log_density_ratio(old_component) -
         log_forward;
}

}  // namespace wheeltap::inference
