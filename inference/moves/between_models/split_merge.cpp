#include "inference/moves/between_models/split_merge.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wheeltap::inference {

std::optional<double> SplitMerge::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const auto j = static_cast<std::size_t>(kind_);
  const std::vector<Parameter>& parameters = space.kinds()[j].parameters;
  const std::size_t width = parameters.size();
  const bool split = step.random.uniform() < 0.5;
  const int model = space.neighbour(from.model, kind_, split ? +1 : -1);
  const int k = space[from.model].counts[j];
  if (model < 0 || (split ? k < 1 : k < 2)) return std::nullopt;
  to.model = model;
  const int chosen = step.random.index(split ? k : k - 1);
  const auto at = static_cast<std::ptrdiff_t>(space.component(from.model, kind_, chosen).first);

  // one[i]: the component before the split; first[i] and second[i]: the two components after the
  // split. First in the additive quantity, later in physical units.
  const auto to_sum = [&](std::size_t i, double a) {
    return compounds_ && i > 0 ? -std::log1p(-a) : a;
  };
  const auto from_sum = [&](std::size_t i, double s) {
    return compounds_ && i > 0 ? -std::expm1(-s) : s;
  };
  std::vector<double> one(width), first(width), second(width);
  double w = 0.0;
  if (split) {
    const HalfNormal g{width_};
    w = Prior(g).from_standard_normal(step.random.normal());
    for (std::size_t i = 0; i < width; ++i) {
      one[i] = to_sum(i, from.x[static_cast<std::size_t>(at) + i]);
      const double share = i == 0 ? 0.0 : step.random.uniform();
      first[i] = i == 0 ? one[i] - w : share * one[i];
      second[i] = i == 0 ? one[i] + w : (1.0 - share) * one[i];
    }
  } else {
    for (std::size_t i = 0; i < width; ++i) {
      first[i] = to_sum(i, from.x[static_cast<std::size_t>(at) + i]);
      second[i] = to_sum(i, from.x[static_cast<std::size_t>(at) + width + i]);
      one[i] = i == 0 ? 0.5 * (first[i] + second[i]) : first[i] + second[i];
      // The shares s_i must lie in (0, 1); otherwise, no merge and split could produce this state.
      if (i > 0 && !(first[i] * second[i] > 0.0)) return std::nullopt;
    }
    w = 0.5 * (second[0] - first[0]);
  }
  if (!std::ranges::all_of(one, [](double v) { return std::isfinite(v); })) return std::nullopt;

  double log_split = -Prior(HalfNormal{width_}).log_density(w) + std::log(2.0);
  std::vector<double> z;
  for (std::size_t i = 0; i < width; ++i) {
    if (i > 0) log_split += std::log(std::abs(one[i]));
    const Prior& prior = parameters[i].prior;
    for (std::vector<double>* component : {&one, &first, &second}) {
      (*component)[i] = from_sum(i, (*component)[i]);
    }
    // ln |dz/ds| for the additive quantity s.
    const auto log_dz_dx = [&](double x) {
      const double value = prior.to_standard_normal(x);
      return prior.log_density(x) + 0.5 * value * value + 0.91893853320467274178 +
             (compounds_ && i > 0 ? std::log1p(-x) : 0.0);
    };
    log_split += log_dz_dx(first[i]) + log_dz_dx(second[i]) - log_dz_dx(one[i]);
  }
  if (!std::isfinite(log_split)) return std::nullopt;  // a component is outside its prior

  const auto end = at + static_cast<std::ptrdiff_t>(split ? width : 2 * width);
  to.z.erase(to.z.begin() + at, to.z.begin() + end);
  for (const std::vector<double>& component : {first, second}) {
    for (std::size_t i = 0; i < width; ++i) {
      const double x = split ? component[i] : one[i];
      z.push_back(parameters[i].prior.to_standard_normal(x));
      if (!std::isfinite(z.back())) return std::nullopt;
    }
    if (!split) break;
  }
  to.z.insert(to.z.begin() + at, z.begin(), z.end());
  if (!step.target.is_sorted(to)) return std::nullopt;  // no merge reverses this split
  return split ? log_split : -log_split;
}

}  // namespace wheeltap::inference
