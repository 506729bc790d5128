#include "inference/moves/between_models/model_switch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wheeltap::inference {

std::optional<double> ModelSwitch::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  if (space.size() < 2 || !space.kinds().empty()) return std::nullopt;
  to.model = step.random.index(space.size() - 1);
  if (to.model >= from.model) ++to.model;
  const std::vector<int>& had = space[from.model].parameters;
  const std::vector<int>& has = space[to.model].parameters;
  const auto log_phi = [](double z) { return -0.5 * (z * z + std::log(2.0 * std::numbers::pi)); };
  double log_ratio = 0.0;
  to.z.resize(has.size());
  for (std::size_t i = 0; i < has.size(); ++i) {
    const auto shared = std::find(had.begin(), had.end(), has[i]);
    if (shared != had.end()) {
      to.z[i] = from.z[static_cast<std::size_t>(shared - had.begin())];
    } else {
      to.z[i] = step.random.normal();
      log_ratio -= log_phi(to.z[i]);
    }
  }
  for (std::size_t i = 0; i < had.size(); ++i) {
    if (std::find(has.begin(), has.end(), had[i]) == has.end()) log_ratio += log_phi(from.z[i]);
  }
  return log_ratio;
}

}  // namespace wheeltap::inference
