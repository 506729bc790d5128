#include "inference/moves/multiscale_walk.hpp"

#include <cmath>

namespace wheeltap::inference {

std::optional<double> MultiscaleWalk::propose(const State& from, const Step& step, State& to) {
  constexpr double kShortest = 1e-3, kLongest = 3.0;  // relative to S
  const std::vector<RandomWalk::Block>& blocks = scales_[static_cast<std::size_t>(from.model)];
  if (blocks.empty()) return std::nullopt;
  const RandomWalk::Block& all = blocks.back();
  const Eigen::Index d = all.factor.rows();
  const double f = kShortest * std::pow(kLongest / kShortest, step.random.uniform());
  if (step.random.uniform() < 0.5) {
    const Eigen::Index i = step.random.index(static_cast<int>(d));
    // S contains 2.38/√d standard deviations.
    const double width = all.factor.row(i).head(i + 1).norm() * std::sqrt(static_cast<double>(d));
    to.z[static_cast<std::size_t>(all.first + i)] += f * width * step.random.normal();
  } else {
    u_.resize(static_cast<std::size_t>(d));
    for (double& u : u_) u = step.random.normal();
    for (Eigen::Index i = 0; i < d; ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k <= i; ++k)
        sum += all.factor(i, k) * u_[static_cast<std::size_t>(k)];
      to.z[static_cast<std::size_t>(all.first + i)] += f * sum;
    }
  }
  if (!step.target.is_sorted(to)) return std::nullopt;
  return 0.0;
}

}  // namespace wheeltap::inference
