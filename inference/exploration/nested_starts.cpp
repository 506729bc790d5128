#include "inference/exploration/nested_starts.hpp"

#include <algorithm>
#include <numeric>

namespace wheeltap::inference {
namespace {

constexpr double kLittle = -1.5;  // z

}  // namespace

bool is_within(const Model& inner, const Model& outer) {
  return std::ranges::all_of(inner.parameters, [&](int p) {
    return std::ranges::find(outer.parameters, p) != outer.parameters.end();
  });
}

bool is_nested(const ModelSpace& space) {
  if (!space.kinds().empty()) return false;
  const Model& least = space[by_dimension(space).front()];
  return std::ranges::all_of(space.models(),
                             [&](const Model& model) { return is_within(least, model); });
}

std::vector<int> by_dimension(const ModelSpace& space) {
  std::vector<int> order(static_cast<std::size_t>(space.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int m) { return space[m].dimension; });
  return order;
}

std::vector<std::vector<double>> nested_starts(const ModelSpace& space, int model,
                                               const std::vector<ModelExploration>& explorations,
                                               std::size_t most) {
  const std::vector<int>& own = space[model].parameters;
  std::vector<int> nested;
  for (int m = 0; m < space.size(); ++m) {
    if (space[m].parameters.size() >= own.size() ||
        explorations[static_cast<std::size_t>(m)].modes.empty())
      continue;
    if (is_within(space[m], space[model])) nested.push_back(m);
  }
  std::ranges::stable_sort(nested, [&](int a, int b) {
    if (space[a].dimension != space[b].dimension) return space[a].dimension > space[b].dimension;
    return explorations[static_cast<std::size_t>(a)].log_evidence() >
           explorations[static_cast<std::size_t>(b)].log_evidence();
  });
  if (nested.size() > most) nested.resize(most);
  std::vector<std::vector<double>> starts;
  for (const int m : nested) {
    const std::vector<int>& theirs = space[m].parameters;
    const std::vector<double>& mode = explorations[static_cast<std::size_t>(m)].modes.front().z;
    for (const double fill : {0.0, kLittle}) {
      std::vector<double>& z = starts.emplace_back(own.size(), fill);
      for (std::size_t i = 0; i < theirs.size(); ++i)
        z[static_cast<std::size_t>(std::ranges::find(own, theirs[i]) - own.begin())] = mode[i];
    }
  }
  return starts;
}

}  // namespace wheeltap::inference
