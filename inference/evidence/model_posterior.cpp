#include "inference/evidence/model_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "inference/standard_normal.hpp"

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
  for (const int k : m.counts) constant_ += std::lgamma(k + 1.0);
}

ModelPosterior::Value ModelPosterior::operator()(std::span<const double> z) {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  constexpr Value kImpossible{kNever, kNever, kNever, kNever};
  std::ranges::copy(z, state_.z.begin());
  double square = 0.0;
  for (const double v : z) square += v * v;
  if (!std::isfinite(square) || !target_.is_sorted(state_)) return kImpossible;
  target_.evaluate(state_);
  const double base = constant_ - 0.5 * square;
  return {base + state_.log_prior_factor, base, state_.log_likelihood,
          state_.log_prior_factor + state_.log_likelihood};
}

void ModelPosterior::draw_prior(Random& random, std::span<double> z) {
  target_.draw_prior(state_.model, random, state_);
  std::ranges::copy(state_.z, z.begin());
}

}  // namespace wheeltap::inference
