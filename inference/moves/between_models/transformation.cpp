#include "inference/moves/between_models/transformation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace wheeltap::inference {

namespace {

// Computes Σ ln |dz/dx| = Σ ln p(x) - ln φ(z).
double log_dz_dx(const ModelSpace& space, const State& state, std::span<const double> x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < state.z.size(); ++i) {
    sum += space.prior(state.model, static_cast<int>(i)).log_density(x[i]) +
           0.5 * state.z[i] * state.z[i] + 0.91893853320467274178;
  }
  return sum;
}

double log_density(const std::vector<Prior>& priors, std::span<const double> values) {
  double sum = 0.0;
  for (std::size_t i = 0; i < priors.size(); ++i) sum += priors[i].log_density(values[i]);
  return sum;
}

}  // namespace

Transformation::Transformation(const ModelSpace& space, Definition definition)
    : definition_(std::move(definition)) {
  const auto lower = static_cast<std::size_t>(space[definition_.lower].dimension) +
                     definition_.lower_auxiliaries.size();
  const auto upper = static_cast<std::size_t>(space[definition_.upper].dimension) +
                     definition_.upper_auxiliaries.size();
  if (lower != upper) {
    throw std::invalid_argument("the map between models has " + std::to_string(lower) +
                                " inputs and " + std::to_string(upper) +
                                " outputs; the numbers must be equal");
  }
  in_.resize(lower);
  out_.resize(lower);
  back_.resize(lower);
}

std::optional<double> Transformation::propose(const State& from, const Step& step, State& to) {
  const bool up = from.model == definition_.lower;
  if (!up && from.model != definition_.upper) return std::nullopt;
  const ModelSpace& space = step.target.space();
  const auto& g_from = up ? definition_.lower_auxiliaries : definition_.upper_auxiliaries;
  const auto& g_to = up ? definition_.upper_auxiliaries : definition_.lower_auxiliaries;
  const std::size_t d = from.x.size();
  std::copy(from.x.begin(), from.x.end(), in_.begin());
  for (std::size_t i = 0; i < g_from.size(); ++i) {
    in_[d + i] = g_from[i].from_standard_normal(step.random.normal());
  }
  const double log_jacobian = (up ? definition_.forward : definition_.inverse)(in_, out_);
  if (!std::isfinite(log_jacobian)) return std::nullopt;  // outside the map's domain

  const double log_inverse = (up ? definition_.inverse : definition_.forward)(out_, back_);
  for (std::size_t i = 0; i < in_.size(); ++i) {
    if (!(std::abs(back_[i] - in_[i]) <= 1e-8 * (1.0 + std::abs(in_[i])))) {
      throw std::logic_error("a jump between '" + space[definition_.lower].name + "' and '" +
                             space[definition_.upper].name + "' is not reversible: variable " +
                             std::to_string(i) + " is " + std::to_string(in_[i]) + " before and " +
                             std::to_string(back_[i]) + " after both maps");
    }
  }
  if (std::abs(log_jacobian + log_inverse) > 1e-8 * (1.0 + std::abs(log_jacobian))) {
    throw std::logic_error("the log-Jacobians of a jump and its inverse are " +
                           std::to_string(log_jacobian) + " and " + std::to_string(log_inverse) +
                           "; their sum must be 0");
  }

  to.model = up ? definition_.upper : definition_.lower;
  const auto d_to = static_cast<std::size_t>(space[to.model].dimension);
  to.z.resize(d_to);
  for (std::size_t i = 0; i < d_to; ++i) {
    to.z[i] = space.prior(to.model, static_cast<int>(i)).to_standard_normal(out_[i]);
    if (!std::isfinite(to.z[i])) return std::nullopt;  // outside the prior's support
  }
  if (!step.target.is_sorted(to)) return std::nullopt;
  const std::span<const double> in(in_), out(out_);
  return log_density(g_to, out.subspan(d_to)) - log_density(g_from, in.subspan(d)) + log_jacobian +
         log_dz_dx(space, to, out) - log_dz_dx(space, from, in);
}

Transformation::Definition Transformation::nested(const ModelSpace& space, int lower, int upper,
                                                  double mean, double sd) {
  const std::vector<int>& few = space[lower].parameters;
  const std::vector<int>& many = space[upper].parameters;
  if (many.size() != few.size() + 1 || !space.kinds().empty()) {
    throw std::invalid_argument("model '" + space[upper].name +
                                "' must have exactly one parameter more than '" +
                                space[lower].name + "'");
  }
  // Index of each parameter of the larger model in the input. The new parameter is the auxiliary
  // variable, the last entry of the input.
  std::vector<std::size_t> source;
  for (const int p : many) {
    source.push_back(static_cast<std::size_t>(std::find(few.begin(), few.end(), p) - few.begin()));
  }
  if (std::count(source.begin(), source.end(), few.size()) != 1) {
    throw std::invalid_argument("model '" + space[upper].name +
                                "' must have all the parameters of '" + space[lower].name + "'");
  }
  return {.lower = lower,
          .upper = upper,
          .lower_auxiliaries = {Normal{mean, sd}},
          .upper_auxiliaries = {},
          .forward =
              [source](std::span<const double> from, std::span<double> to) {
                for (std::size_t i = 0; i < source.size(); ++i) to[i] = from[source[i]];
                return 0.0;
              },
          .inverse =
              [source](std::span<const double> from, std::span<double> to) {
                for (std::size_t i = 0; i < source.size(); ++i) to[source[i]] = from[i];
                return 0.0;
              }};
}

}  // namespace wheeltap::inference
