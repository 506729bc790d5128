#include "inference/exploration/occams_window.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "inference/exploration/nested_starts.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kWindow = 12.0;  // ln (P Z), below the most probable model
constexpr double kHigher = 10.0;  // ln π of a mode above that of the most probable model
constexpr int kAllUpTo = 2;       // steps from the smallest model

double log_mass(const ModelSpace& space, int m, const ModelExploration& found) {
  return space[m].log_prior + found.log_evidence();
}

double height(const ModelExploration& found) {
  double most = -kInfinity;
  for (const Mode& mode : found.modes) most = std::max(most, mode.log_posterior);
  return most;
}

}  // namespace

ModelLattice::ModelLattice(const ModelSpace& space)
    : places_(static_cast<std::size_t>(space.size())) {
  std::vector<int> order = by_dimension(space);
  std::ranges::stable_sort(order, {}, [&](int m) { return space[m].parameters.size(); });
  for (const int m : order) {
    Place& place = places_[static_cast<std::size_t>(m)];
    // Larger models first: a model within an accepted model is not one step from m.
    for (auto other = order.rbegin(); other != order.rend(); ++other) {
      const int s = *other;
      if (space[s].parameters.size() >= space[m].parameters.size() ||
          !is_within(space[s], space[m]))
        continue;
      if (std::ranges::any_of(place.within, [&](int t) { return is_within(space[s], space[t]); }))
        continue;
      place.within.push_back(s);
      places_[static_cast<std::size_t>(s)].around.push_back(m);
    }
    for (const int s : place.within)
      place.level = place.level == 0 ? level(s) + 1 : std::min(place.level, level(s) + 1);
  }
}

std::vector<int> next_in_window(const ModelSpace& space, const ModelLattice& lattice,
                                const std::vector<ModelExploration>& explorations) {
  const auto models = static_cast<std::size_t>(space.size());
  std::vector<bool> open(models), asked(models, false);
  double most = -kInfinity, top = -kInfinity;  // ln (P Z) and ln π of the most probable model
  for (std::size_t at = 0; at < models; ++at) {
    const int m = static_cast<int>(at);
    const ModelExploration& found = explorations[at];
    open[at] = std::isfinite(space[m].log_prior) && !found.is_explored();
    asked[at] = lattice.level(m) <= kAllUpTo;
    if (open[at] || !(log_mass(space, m, found) > most)) continue;
    most = log_mass(space, m, found);
    top = height(found);
  }
  const auto ask = [&](const std::vector<int>& list) {
    for (const int m : list) asked[static_cast<std::size_t>(m)] = true;
  };
  for (std::size_t at = 0; at < models; ++at) {
    const int m = static_cast<int>(at);
    const ModelExploration& found = explorations[at];
    if (!found.is_explored()) continue;
    const bool likely = log_mass(space, m, found) > most - kWindow;
    if (likely) ask(lattice.around(m));
    if (likely || height(found) > top + kHigher) ask(lattice.within(m));
  }
  std::vector<int> next;
  const auto take = [&](auto&& wanted) {
    for (const int m : by_dimension(space))
      if (open[static_cast<std::size_t>(m)] && wanted(m)) next.push_back(m);
  };
  take([&](int m) { return asked[static_cast<std::size_t>(m)]; });
  if (next.empty()) take([&](int m) { return lattice.around(m).empty(); });
  return next;
}

std::vector<double> start_from_around(const ModelSpace& space, const ModelLattice& lattice, int m,
                                      const std::vector<ModelExploration>& explorations) {
  int best = -1;
  double most = -kInfinity;
  for (const int around : lattice.around(m)) {
    const ModelExploration& found = explorations[static_cast<std::size_t>(around)];
    if (found.modes.empty() || !(log_mass(space, around, found) > most)) continue;
    most = log_mass(space, around, found);
    best = around;
  }
  std::vector<double> start;
  if (best < 0) return start;
  const std::vector<int>& theirs = space[best].parameters;
  const std::vector<double>& z = explorations[static_cast<std::size_t>(best)].modes.front().z;
  for (const int p : space[m].parameters)
    start.push_back(z[static_cast<std::size_t>(std::ranges::find(theirs, p) - theirs.begin())]);
  return start;
}

}  // namespace wheeltap::inference
