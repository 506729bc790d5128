#include "inference/moves/mirror.hpp"

#include <cmath>

namespace wheeltap::inference {

std::optional<double> Mirror::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  int components = 0;
  for (const Reflection& reflection : reflections_) {
    components += space[from.model].counts[static_cast<std::size_t>(reflection.kind)];
  }
  if (components == 0) return std::nullopt;
  const int only = whole_ ? -1 : step.random.index(components);
  double log_ratio = 0.0;
  int component = 0;
  for (const Reflection& reflection : reflections_) {
    const auto j = static_cast<std::size_t>(reflection.kind);
    const ComponentKind& kind = space.kinds()[j];
    const Prior& prior = kind.parameters[static_cast<std::size_t>(reflection.parameter)].prior;
    for (int c = 0; c < space[from.model].counts[j]; ++c, ++component) {
      if (!whole_ && component != only) continue;
      const std::size_t i = space.component(from.model, reflection.kind, c).first +
                            static_cast<std::size_t>(reflection.parameter);
      const double image = 2.0 * reflection.center - from.x[i];
      to.z[i] = prior.to_standard_normal(image);
      if (!std::isfinite(to.z[i])) return std::nullopt;
      log_ratio += prior.log_density(image) - prior.log_density(from.x[i]) +
                   0.5 * (to.z[i] * to.z[i] - from.z[i] * from.z[i]);
    }
  }
  step.target.sort_components(to);
  return log_ratio;
}

}  // namespace wheeltap::inference
