#include "inference/moves/mixture_jump.hpp"

#include <cmath>

namespace wheeltap::inference {

int propose_model(const PilotFit& fit, int from, base::Random& random, double& log_ratio) {
  const std::vector<double>& weight = fit.weight;
  const auto m = static_cast<std::size_t>(from);
  double u = random.uniform() * (1.0 - weight[m]);
  int chosen = -1;
  for (int other = 0; other < static_cast<int>(weight.size()); ++other) {
    if (other == from) continue;
    chosen = other;
    u -= weight[static_cast<std::size_t>(other)];
    if (u < 0.0) break;
  }
  if (chosen < 0) return -1;
  const auto other = static_cast<std::size_t>(chosen);
  log_ratio +=
      std::log(weight[m] / (1.0 - weight[other])) - std::log(weight[other] / (1.0 - weight[m]));
  return chosen;
}

std::optional<double> MixtureJump::propose(const State& from, const Step& step, State& to) {
  const ModelSpace& space = step.target.space();
  double log_ratio = 0.0;
  if (between_) {
    to.model = propose_model(*fit_, from.model, step.random, log_ratio);
    if (to.model < 0) return std::nullopt;
  }
  const auto target = static_cast<std::size_t>(to.model);
  to.z.resize(static_cast<std::size_t>(space[to.model].dimension));
  if (fit_->density[target]) {
    fit_->density[target]->sample(step.random, to.z);
    if (!step.target.is_sorted(to)) return std::nullopt;
  } else if (to.model == from.model) {
    return std::nullopt;  // no parameters: nothing to propose
  }
  return log_ratio + fit_->log_density(from.model, from.z) - fit_->log_density(to.model, to.z);
}

}  // namespace wheeltap::inference
