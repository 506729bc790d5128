#include "inference/moves/random_walk.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"

namespace wheeltap::inference {

RandomWalk::Scales RandomWalk::initial_scales(const ModelSpace& space) {
  Scales scales;
  for (int m = 0; m < space.size(); ++m) {
    const Model& model = space[m];
    std::vector<Block>& blocks = scales.emplace_back();
    const auto add = [&](int first, int size) {
      if (size > 0)
        blocks.push_back({.first = first, .factor = Eigen::MatrixXd::Identity(size, size)});
    };
    add(0, static_cast<int>(model.parameters.size()));
    for (std::size_t j = 0; j < space.kinds().size(); ++j) {
      for (int c = 0; c < model.counts[j]; ++c) {
        const ComponentRange at = space.component(m, static_cast<int>(j), c);
        add(static_cast<int>(at.first), static_cast<int>(at.width));
      }
    }
    if (blocks.size() > 1) add(0, model.dimension);
  }
  return scales;
}

std::optional<double> RandomWalk::propose(const State& from, const Step& step, State& to) {
  std::vector<Block>& blocks = scales_[static_cast<std::size_t>(from.model)];
  if (blocks.empty()) return std::nullopt;
  block_ = &blocks[static_cast<std::size_t>(step.random.index(static_cast<int>(blocks.size())))];
  const double v = step.random.uniform();
  factor_ = v < 0.7 ? 1.0 : v < 0.9 ? 0.1 : 4.0;
  const Eigen::Index d = block_->factor.rows();
  u_.resize(d);
  for (double& value : u_) value = step.random.normal();
  for (Eigen::Index i = 0; i < d; ++i) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k <= i; ++k) sum += block_->factor(i, k) * u_[k];
    to.z[static_cast<std::size_t>(block_->first + i)] += factor_ * sum;
  }
  // Each position in the order has its own scale. A step that changes the order would therefore not
  // be symmetric.
  if (!step.target.is_sorted(to)) {
    if (step.adapting) adapt(0.0, from);
    return std::nullopt;
  }
  return 0.0;
}

void RandomWalk::adapt(double acceptance_probability, const State&) {
  if (factor_ == 1.0) learn(*block_, u_, acceptance_probability);
}

void RandomWalk::save(const Scales& scales, std::vector<double>& numbers) {
  for (const std::vector<Block>& blocks : scales) {
    for (const Block& block : blocks) {
      numbers.insert(numbers.end(), block.factor.data(), block.factor.data() + block.factor.size());
      numbers.push_back(static_cast<double>(block.adaptations));
    }
  }
}

void RandomWalk::restore(Scales& scales, std::span<const double>& numbers) {
  for (std::vector<Block>& blocks : scales) {
    for (Block& block : blocks) {
      const auto size = static_cast<std::size_t>(block.factor.size());
      std::copy_n(numbers.begin(), size, block.factor.data());
      block.adaptations = static_cast<long>(numbers[size]);
      numbers = numbers.subspan(size + 1);
    }
  }
}

void RandomWalk::learn(Block& block, const Eigen::VectorXd& u, double acceptance_probability) {
  const Eigen::Index n = block.factor.rows();
  const auto d = static_cast<double>(n);
  const double goal = d < 2 ? 0.44 : d < 4 ? 0.35 : 0.234;
  const double eta =
      std::min(1.0, d * std::pow(static_cast<double>(++block.adaptations), -2.0 / 3.0));
  const double gain = eta * (acceptance_probability - goal) / u.squaredNorm();
  const Eigen::MatrixXd middle = Eigen::MatrixXd::Identity(n, n) + gain * u * u.transpose();
  const Eigen::LLT<Eigen::MatrixXd> llt(block.factor * middle * block.factor.transpose());
  if (llt.info() == Eigen::Success) block.factor = llt.matrixL();
}

}  // namespace wheeltap::inference
