#include "inference/moves/differential_evolution.hpp"

#include <cmath>
#include <utility>

namespace wheeltap::inference {

std::optional<double> DifferentialEvolution::propose(const State& from, const Step& step,
                                                     State& to) {
  const Eigen::MatrixXd& states = (*archive_)[static_cast<std::size_t>(from.model)];
  const int n = static_cast<int>(states.cols());
  if (n < 3 || states.rows() == 0) return std::nullopt;
  const ModelSpace& space = step.target.space();
  const Model& model = space[from.model];
  // Chooses a block: all coordinates, the model's own parameters, or one component.
  Eigen::Index first = 0;
  Eigen::Index size = states.rows();
  int components = 0;
  for (const int k : model.counts) components += k;
  const int own = static_cast<int>(model.parameters.size());
  const int blocks = components + (own > 0 ? 1 : 0);
  if (blocks > 1 && step.random.uniform() < 0.5) {
    int block = step.random.index(blocks);
    if (own > 0 && block-- == 0) {
      size = own;
    } else {
      std::size_t kind = 0;
      while (block >= model.counts[kind]) block -= model.counts[kind++];
      const ComponentRange component = space.component(from.model, static_cast<int>(kind), block);
      first = static_cast<Eigen::Index>(component.first);
      size = static_cast<Eigen::Index>(component.width);
    }
  }
  const auto pair = [&] {
    const int one = step.random.index(n);
    int other = step.random.index(n - 1);
    if (other >= one) ++other;
    return std::pair{one, other};
  };
  const auto [a, b] = pair();
  const auto [c, d] = pair();
  const double gamma =
      step.random.uniform() < 0.1
          ? 1.0
          : 2.38 / std::sqrt(2.0 * static_cast<double>(size)) * (0.4 + 0.6 * step.random.uniform());
  for (Eigen::Index i = first; i < first + size; ++i) {
    const double jitter = 1e-4 * std::fabs(states(i, c) - states(i, d)) + 1e-12;
    to.z[static_cast<std::size_t>(i)] +=
        gamma * (states(i, a) - states(i, b)) + jitter * step.random.normal();
  }
  if (!step.target.is_sorted(to)) return std::nullopt;
  return 0.0;
}

}  // namespace wheeltap::inference
