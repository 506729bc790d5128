// Random walks within a model.
#pragma once

#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// z' = z + f S u with u ~ N(0, I) on a block of the coordinates, chosen uniformly: the model's own
/// parameters, the parameters of one component, or all parameters. The proposal is symmetric, so
/// the ratio is 1. The factor f does not depend on the state: it is 1 in most steps, 0.1 in some
/// steps (for narrow posterior modes), and 4 in the other steps (for wide posterior modes).
///
/// S (lower triangular, one per block and model) adapts in warm-up by robust adaptive Metropolis
/// (Vihola 2012, algorithm RAM). The target α* of the acceptance rate is 0.44 in one dimension and
/// 0.234 in many:
///
///   S Sᵀ ← S (I + η_n (α - α*) u uᵀ / |u|²) Sᵀ,     η_n = min(1, d n^(-2/3)).
class RandomWalk : public Move {
 public:
  /// Proposal scale of one block of one model, adapted in warm-up.
  struct Block {
    int first = 0;  ///< coordinates [first, first + S.rows())
    Eigen::MatrixXd factor;
    long adaptations = 0;
  };
  using Scales = std::vector<std::vector<Block>>;  ///< [model][block]

  /// Adapts S (algorithm RAM) after a proposal S u with this acceptance probability.
  static void learn(Block& block, const Eigen::VectorXd& u, double acceptance_probability);

  /// Returns the blocks of every model, each with S = I. The last block of each model contains all
  /// coordinates.
  [[nodiscard]] static Scales initial_scales(const ModelSpace& space);

  /// Saves S and its number of adaptation steps, block after block; see Kernel::save.
  static void save(const Scales& scales, std::vector<double>& numbers);
  static void restore(Scales& scales, std::span<const double>& numbers);

  explicit RandomWalk(Scales scales) : scales_(std::move(scales)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;
  void adapt(double acceptance_probability, const State& reached) override;
  void save(std::vector<double>& numbers) const override { save(scales_, numbers); }
  void restore(std::span<const double>& numbers) override { restore(scales_, numbers); }
  [[nodiscard]] const Scales& scales() const { return scales_; }

 private:
  Scales scales_;
  Eigen::VectorXd u_;
  double factor_ = 1.0;
  Block* block_ = nullptr;
};

}  // namespace wheeltap::inference
