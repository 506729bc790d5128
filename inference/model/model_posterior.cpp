#include "inference/model/model_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/log_gamma.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {

ModelPosterior::ModelPosterior(const Problem& problem, int model) : target_(problem, false) {
  if (model < 0 || model >= problem.space.size())
    throw std::invalid_argument("model = " + std::to_string(model) + ", must be in [0, " +
                                std::to_string(problem.space.size()) + ")");
  const Model& m = problem.space[model];
  state_.model = model;
  state_.z.assign(static_cast<std::size_t>(m.dimension), 0.0);
  state_.x = state_.z;
  constant_ = -m.dimension * kLogSqrt2Pi;
  for (const int k : m.counts) {
    constant_ += base::log_gamma(k + 1.0);
    has_sets_ = has_sets_ || k > 1;
  }
}

ModelPosterior::Value ModelPosterior::operator()(std::span<const double> z) {
  return above(-std::numeric_limits<double>::infinity(), 1.0, z);
}

ModelPosterior::Value ModelPosterior::above(double level, double beta, std::span<const double> z) {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  constexpr Value kImpossible{kNever, kNever, kNever, kNever};
  std::ranges::copy(z, state_.z.begin());
  double square = 0.0;
  for (const double v : z) square += v * v;
  if (!std::isfinite(square) || !target_.is_sorted(state_)) return kImpossible;
  const double base = constant_ - 0.5 * square;
  // This class tempers the prior factor, but Target does not. With a prior factor, early rejection
  // is therefore not possible.
  target_.screen_above(
      target_.problem().log_prior_factor ? kNever : level - base + target_.log_prior(state_), beta,
      state_);
  target_.complete(state_);
  if (state_.log_likelihood == kNever) return kImpossible;
  return {base + state_.log_prior_factor, base, state_.log_likelihood,
          state_.log_prior_factor + state_.log_likelihood};
}

void ModelPosterior::evaluate(std::span<const double> zs, std::span<Value> out, double level) {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  constexpr double kRounding = 1e-6;  // much larger than the rounding error of a log likelihood
  const auto base_of = [&](const State& state) {
    double base = constant_;
    for (const double v : state.z) base -= 0.5 * v * v;
    return base;
  };
  const std::size_t d = state_.z.size();
  states_.clear();
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {kNever, kNever, kNever, kNever};
    std::ranges::copy(zs.subspan(i * d, d), state_.z.begin());
    const auto finite = [](double v) { return std::isfinite(v); };
    if (!std::ranges::all_of(state_.z, finite) || !target_.is_sorted(state_)) continue;
    states_.push_back(state_);
    places.push_back(i);
  }
  // As in above(): no early rejection with a prior factor.
  std::vector<double> floors;
  if (level > kNever && !target_.problem().log_prior_factor)
    for (const State& state : states_) floors.push_back(level - base_of(state) - kRounding);
  target_.evaluate(states_, floors);
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const State& state = states_[i];
    const double base = base_of(state);
    out[places[i]] = {base + state.log_prior_factor, base, state.log_likelihood,
                      state.log_prior_factor + state.log_likelihood};
  }
}

void ModelPosterior::order(std::span<double> z) {
  if (!has_sets_) return;
  std::ranges::copy(z, state_.z.begin());
  target_.sort_components(state_);
  std::ranges::copy(state_.z, z.begin());
}

bool ModelPosterior::gradient(std::span<const double> z, std::span<double> out) {
  std::ranges::copy(z, state_.z.begin());
  order(state_.z);
  state_.screened = state_.evaluated = false;
  target_.evaluate(state_);
  std::vector<double> ordered(z.size());
  if (!target_.gradient(state_, ordered)) return false;
  // Restores the caller's order of the components.
  std::ranges::copy(ordered, out.begin());
  const Model& model = target_.space()[state_.model];
  for (std::size_t j = 0; j < model.counts.size(); ++j) {
    const auto component = [&](int c) {
      return target_.space().component(state_.model, static_cast<int>(j), c);
    };
    std::vector<int> from(static_cast<std::size_t>(model.counts[j]));
    std::iota(from.begin(), from.end(), 0);
    std::ranges::stable_sort(from, {}, [&](int c) { return z[component(c).first]; });
    for (std::size_t c = 0; c < from.size(); ++c) {
      std::ranges::copy(component(static_cast<int>(c)).of(ordered),
                        component(from[c]).of(out).begin());
    }
  }
  return true;
}

bool ModelPosterior::gauss_newton(std::span<const double> z, std::span<const double> dz,
                                  std::span<double> gradient, std::span<double> information) {
  std::ranges::copy(z, state_.z.begin());
  return target_.gauss_newton(state_, dz, gradient, information);
}

void ModelPosterior::draw_prior(base::Random& random, std::span<double> z) {
  target_.draw_prior(state_.model, random, state_);
  std::ranges::copy(state_.z, z.begin());
}

}  // namespace wheeltap::inference
