#include "inference/model/target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/constants.hpp"
#include "base/log_gamma.hpp"
#include "base/number.hpp"

namespace wheeltap::inference {

namespace {

constexpr long kAtOnce = 20;     // number of first values that must not all be NaN or +∞
constexpr long kEnough = 1000;   // smallest number of values for the share to count
constexpr double kShare = 1e-2;  // largest share of NaN and +∞

std::unique_ptr<Likelihood> make(const LikelihoodFactory& factory, const char* name) {
  std::unique_ptr<Likelihood> made = factory ? factory() : nullptr;
  if (!made)
    throw std::invalid_argument(std::string("the problem's ") + name +
                                (factory ? " factory returned null" : " factory is missing") +
                                "; set prior_only for a run without likelihood");
  return made;
}

std::string state_in_words(const ModelSpace& space, const State& state) {
  std::string text = "model '" + space[state.model].name + "'";
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    text += (i == 0 ? " at " : ", ") + space.parameter_name(state.model, static_cast<int>(i)) +
            " = " + base::number(state.x[i]);
  }
  return text;
}

}  // namespace

Target::Target(const Problem& problem, bool prior_only)
    : problem_(&problem),
      likelihood_(prior_only ? nullptr : make(problem.likelihood, "likelihood")),
      screen_(prior_only || !problem.screen ? nullptr : make(problem.screen, "screen")) {
  for (const Model& model : problem.space.models()) {
    double constant = model.log_prior - 0.5 * model.dimension * std::log(2.0 * std::numbers::pi);
    for (const int k : model.counts) constant += base::log_gamma(k + 1.0);
    memory_.log_model.push_back(constant);
  }
  memory_.bias.assign(memory_.log_model.size(), 0.0);
}

void Target::set_model_bias(const std::vector<double>& bias) {
  for (std::size_t m = 0; m < bias.size(); ++m) {
    memory_.log_model[m] += bias[m] - memory_.bias[m];
  }
  memory_.bias = bias;
}

double Target::call(Likelihood& likelihood, Tally& tally, const State& state, double floor) {
  likelihood.evaluate(floor, state.model, state.x, evaluation_);
  return checked(evaluation_.log_likelihood, tally, state);
}

double Target::checked(double value, Tally& tally, const State& state) const {
  ++tally.values;
  if (!std::isnan(value) && value != kInfinity) return value;
  ++tally.impossible;
  const bool always = tally.values >= kAtOnce && tally.impossible == tally.values;
  const bool often = tally.values >= kEnough && static_cast<double>(tally.impossible) >
                                                    kShare * static_cast<double>(tally.values);
  if (always || often) {
    throw LikelihoodError("the log likelihood is " + base::number(value) + " for " +
                          state_in_words(space(), state) + "; NaN or +∞ so far in " +
                          std::to_string(tally.impossible) + " of " + std::to_string(tally.values) +
                          " values");
  }
  return -kInfinity;
}

bool Target::locate(State& state) const {
  const std::size_t d = state.z.size();
  state.x.resize(d);
  state.screened = true;
  state.evaluated = !screen_;
  state.log_likelihood = state.log_screen = -kInfinity;
  state.log_prior_factor = 0.0;
  for (std::size_t i = 0; i < d; ++i) {
    if (!std::isfinite(state.z[i])) return false;
    state.x[i] = space().prior(state.model, static_cast<int>(i)).from_standard_normal(state.z[i]);
  }
  if (problem_->log_prior_factor) {
    state.log_prior_factor = problem_->log_prior_factor(state.model, state.x);
    if (std::isnan(state.log_prior_factor) || state.log_prior_factor == kInfinity) {
      throw LikelihoodError("the log prior factor is " + base::number(state.log_prior_factor) +
                            " for " + state_in_words(space(), state));
    }
    if (state.log_prior_factor == -kInfinity) return false;
  }
  return true;
}

void Target::screen(State& state) {
  screen_above(-kInfinity, 1.0, state);
}

void Target::screen_above(double level, double beta, State& state) {
  if (!locate(state)) return;
  if (!likelihood_) {
    state.log_likelihood = state.log_screen = 0.0;
    return;
  }
  ++memory_.evaluations;
  Likelihood& cheapest = screen_ ? *screen_ : *likelihood_;
  // The margin is much larger than the rounding error of a log likelihood.
  const double floor = beta > 0.0 ? (level - log_prior(state)) / beta - 1e-6 : -kInfinity;
  state.log_screen = call(cheapest, screen_ ? memory_.stand_in : memory_.proper, state,
                          std::isnan(floor) ? -kInfinity : floor);
  state.residuals = evaluation_.residuals;
  state.noise_scale = evaluation_.noise_scale;
  if (screen_) return;
  state.log_likelihood = state.log_screen;
  state.prediction = evaluation_.prediction;
}

void Target::complete(State& state) {
  if (state.evaluated) return;
  state.evaluated = true;
  if (state.log_screen == -kInfinity) return;
  ++memory_.full_evaluations;
  state.log_likelihood = call(*likelihood_, memory_.proper, state, -kInfinity);
  state.prediction = evaluation_.prediction;
}

void Target::evaluate(State& state) {
  screen(state);
  complete(state);
}

void Target::evaluate(std::span<State> states, std::span<const double> floors) {
  if (screen_ || !likelihood_) {
    for (State& state : states) evaluate(state);
    return;
  }
  batch_x_.clear();
  batch_floors_.clear();
  std::size_t possible = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    State& state = states[i];
    state.evaluated = true;
    if (!locate(state)) continue;
    batch_x_.insert(batch_x_.end(), state.x.begin(), state.x.end());
    if (!floors.empty()) batch_floors_.push_back(floors[i]);
    state.log_likelihood = 0.0;
    ++possible;
  }
  if (possible == 0) return;
  batch_values_.resize(possible);
  if (floors.empty())
    likelihood_->log_likelihoods(states.front().model, batch_x_, batch_values_);
  else
    likelihood_->log_likelihoods_above(batch_floors_, states.front().model, batch_x_,
                                       batch_values_);
  memory_.evaluations += static_cast<long>(possible);
  std::size_t next = 0;
  for (State& state : states) {
    if (state.log_likelihood == -kInfinity) continue;
    state.log_likelihood = state.log_screen = checked(batch_values_[next++], memory_.proper, state);
  }
}

bool Target::gradient(const State& state, std::span<double> dz) {
  if (screen_ || problem_->log_prior_factor || state.log_likelihood == -kInfinity) return false;
  std::ranges::fill(dz, 0.0);
  if (likelihood_) {
    if (!likelihood_->gradient(state.model, state.x, dz)) return false;
    ++memory_.evaluations;
  }
  for (std::size_t i = 0; i < dz.size(); ++i) {
    const double z = state.z[i];
    dz[i] = dz[i] * space().prior(state.model, static_cast<int>(i)).slope(z) - z;
    if (!std::isfinite(dz[i])) return false;
  }
  return true;
}

bool Target::gauss_newton(State& state, std::span<const double> dz, std::span<double> gradient,
                          std::span<double> information) {
  if (screen_ || problem_->log_prior_factor || !likelihood_ || !space().kinds().empty() ||
      !locate(state))
    return false;
  const std::size_t d = state.z.size();
  std::vector<double> steps(d);
  for (std::size_t i = 0; i < d; ++i) {
    steps[i] =
        space().prior(state.model, static_cast<int>(i)).from_standard_normal(state.z[i] + dz[i]) -
        state.x[i];
  }
  if (!likelihood_->gauss_newton(state.model, state.x, steps, gradient, information)) return false;
  memory_.evaluations += has_exact_derivatives() ? 2 : static_cast<long>(d) + 1;
  for (std::size_t i = 0; i < d; ++i) {
    gradient[i] = gradient[i] / dz[i] - state.z[i];
    if (!std::isfinite(gradient[i])) return false;
    for (std::size_t j = 0; j < d; ++j) {
      double& entry = information[i * d + j];
      entry = entry / (dz[i] * dz[j]) + (i == j ? 1.0 : 0.0);
      if (!std::isfinite(entry)) return false;
    }
    // The map x(z) contributes -∂ ln p/∂x x''(z) to the information. This term is used only where
    // it is positive; it keeps a parameter away from the bound of its prior.
    constexpr double kApart = 1e-3;
    const Prior& prior = space().prior(state.model, static_cast<int>(i));
    const double slope = prior.slope(state.z[i]);
    const double bend = (prior.slope(state.z[i] + kApart) - prior.slope(state.z[i] - kApart)) /
                        (2.0 * kApart * slope) * (gradient[i] + state.z[i]);
    if (bend < 0.0) information[i * d + i] -= bend;
  }
  return true;
}

double Target::log_prior(const State& state) const {
  double square = 0.0;
  for (const double z : state.z) square += z * z;
  return memory_.log_model[static_cast<std::size_t>(state.model)] - 0.5 * square +
         state.log_prior_factor;
}

double Target::log_prior_physical(const State& state) const {
  const Model& model = space()[state.model];
  double sum = model.log_prior + state.log_prior_factor;
  for (const int k : model.counts) sum += base::log_gamma(k + 1.0);
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    sum += space().prior(state.model, static_cast<int>(i)).log_density(state.x[i]);
  }
  return sum;
}

void Target::draw_prior(base::Random& random, State& state) const {
  double u = random.uniform();
  int model = 0;
  for (; model + 1 < space().size(); ++model) {
    u -= std::exp(space()[model].log_prior);
    if (u < 0.0) break;
  }
  draw_prior(model, random, state);
}

void Target::draw_prior(int model, base::Random& random, State& state) const {
  state.model = model;
  state.z.resize(static_cast<std::size_t>(space()[model].dimension));
  for (double& z : state.z) z = random.normal();
  state.screened = state.evaluated = false;
  sort_components(state);
}

bool Target::is_sorted(const State& state) const {
  const std::vector<int>& counts = space()[state.model].counts;
  for (int kind = 0; kind < static_cast<int>(counts.size()); ++kind) {
    for (int c = 1; c < counts[static_cast<std::size_t>(kind)]; ++c) {
      if (state.z[space().component(state.model, kind, c).first] <
          state.z[space().component(state.model, kind, c - 1).first])
        return false;
    }
  }
  return true;
}

bool Target::sort_components(State& state) const {
  if (is_sorted(state)) return true;
  const std::vector<int>& counts = space()[state.model].counts;
  for (int kind = 0; kind < static_cast<int>(counts.size()); ++kind) {
    const auto component = [&](int c) {
      return space().component(state.model, kind, c).of(state.z);
    };
    // Insertion sort of whole components, because the few components are nearly sorted.
    for (int c = 1; c < counts[static_cast<std::size_t>(kind)]; ++c) {
      for (int b = c; b > 0 && component(b)[0] < component(b - 1)[0]; --b) {
        std::ranges::swap_ranges(component(b), component(b - 1));
      }
    }
  }
  return false;
}

}  // namespace wheeltap::inference
