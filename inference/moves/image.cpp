#include "inference/moves/image.hpp"

#include <cmath>

namespace wheeltap::inference {

std::optional<double> Image::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  const std::size_t which =
      symmetries_.size() == 1
          ? 0
          : static_cast<std::size_t>(step.random.index(static_cast<int>(symmetries_.size())));
  const Symmetry& symmetry = symmetries_[which];
  int components = 0;
  for (const Symmetry::Part& part : symmetry.parts) {
    components += space[from.model].counts[static_cast<std::size_t>(part.kind)];
  }
  if (components == 0) return std::nullopt;
  const int only = whole_ ? -1 : step.random.index(components);
  double log_ratio = 0.0;
  int component = 0;
  for (const Symmetry::Part& part : symmetry.parts) {
    const auto j = static_cast<std::size_t>(part.kind);
    const ComponentKind& kind = space.kinds()[j];
    const Prior& prior = kind.parameters[static_cast<std::size_t>(part.parameter)].prior;
    for (int c = 0; c < space[from.model].counts[j]; ++c, ++component) {
      if (!whole_ && component != only) continue;
      const std::size_t i = space.component(from.model, part.kind, c).first +
                            static_cast<std::size_t>(part.parameter);
      const double image = part.image(from.x[i]);
      if (std::isnan(image)) return std::nullopt;
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
