#include "inference/moves/mirror.hpp"

#include <cmath>

namespace wheeltap::inference {

std::optional<double> Mirror::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const auto j = static_cast<std::size_t>(reflection_.kind);
  const int k = space[from.model].counts[j];
  if (k == 0) return std::nullopt;
  const ComponentKind& kind = space.kinds()[j];
  const Prior& prior = kind.parameters[static_cast<std::size_t>(reflection_.parameter)].prior;
  const int first = whole_ ? 0 : step.random.index(k);
  const int last = whole_ ? k : first + 1;
  double log_ratio = 0.0;
  for (int c = first; c < last; ++c) {
    const auto i = static_cast<std::size_t>(space[from.model].offsets[j] +
                                            c * static_cast<int>(kind.parameters.size()) +
                                            reflection_.parameter);
    const double image = 2.0 * reflection_.center - from.x[i];
    to.z[i] = prior.to_standard_normal(image);
    if (!std::isfinite(to.z[i])) return std::nullopt;
    // |dz'/dz| = |dz'/dx'| |dx'/dx| |dx/dz| = [p(x')/φ(z')] [φ(z)/p(x)]
    log_ratio += prior.log_density(image) - prior.log_density(from.x[i]) +
                 0.5 * (to.z[i] * to.z[i] - from.z[i] * from.z[i]);
  }
  step.target.sort_components(to);
  return log_ratio;
}

}  // namespace wheeltap::inference
