// Proposals for a new component: from its prior, or informed by the current residual.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "base/random.hpp"
#include "inference/model/target.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Proposes the standard normal coordinates of one component that is added to a given state.
class ComponentProposal {
 public:
  virtual ~ComponentProposal() = default;

  /// Prepares the proposal of a component that is added to the state `context`. If `skip` >= 0,
  /// component `skip` of `kind` is first removed from `context`. `beta` is the inverse temperature,
  /// which reduces the influence of the residual.
  virtual void condition(const State& context, int kind, int skip, double beta) = 0;
  /// Draws the coordinates z of a component from the conditioned proposal.
  virtual void draw(base::Random& random, std::span<double> z) = 0;
  /// ln [ q(z) / ∏ φ(z_i) ] of the conditioned proposal, its density relative to the prior.
  [[nodiscard]] virtual double log_density_ratio(std::span<const double> z) const = 0;
};

/// Proposes from the prior, so that the density ratio is 1.
class PriorProposal : public ComponentProposal {
 public:
  void condition(const State&, int, int, double) override {}
  void draw(base::Random& random, std::span<double> z) override {
    for (double& value : z) value = random.normal();
  }
  [[nodiscard]] double log_density_ratio(std::span<const double>) const override { return 0.0; }
};

/// Effect of one component alone on the residuals, on a grid of cells of equal prior probability:
/// the *effect* of cell c is D_c = r(one component at the cell's centre) - r(none). Computed once
/// and shared by all threads.
struct EffectAtlas {
  std::vector<int> cells;  ///< number of cells along each parameter of the component
  int total = 0;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      effects;                  ///< total × residuals
  Eigen::VectorXf half_square;  ///< ½ |D_c|² of each cell
  double noise_scale = 1.0;     ///< noise scale for which the effects were computed

  /// Cost of computing the weights of all cells once, expressed as a number of likelihood
  /// evaluations. Each residual of each cell counts as one multiplication, and each exponential as
  /// ten multiplications.
  [[nodiscard]] double work() const {
    return static_cast<double>(total) * (static_cast<double>(effects.cols()) + 10.0) /
           kOperationsACall;
  }
  /// The cell that contains z.
  [[nodiscard]] int cell(std::span<const double> z) const;
};

/// Computes the table of `kind`. Null if the likelihood gives no residuals. Also null if no two
/// models differ only in having 0 and 1 components of this kind.
[[nodiscard]] std::shared_ptr<const EffectAtlas> make_atlas(Target& target, int kind);

/// Informed birth. If r is the residual of the state, a new component in cell c changes r to about
/// r + D_c. The move chooses one of the N cells with the probability
///
///   q(c) = ε / N + (1 - ε) softmax_c( -½ β |r + D_c|² ),
/// and draws the parameters of the component from the prior within this cell.
///
/// Because of the term with ε, every location can be proposed. If `condition` excludes the
/// component `skip` of the state, the effect of this component is first subtracted from the
/// residual.
class InformedProposal : public ComponentProposal {
 public:
  InformedProposal(std::shared_ptr<const EffectAtlas> atlas, const ModelSpace& space, int kind);
  void condition(const State& context, int kind, int skip, double beta) override;
  void draw(base::Random& random, std::span<double> z) override;
  [[nodiscard]] double log_density_ratio(std::span<const double> z) const override;

 private:
  static constexpr double kDefensive = 0.2;  ///< weight ε of the prior in the proposal

  std::shared_ptr<const EffectAtlas> atlas_;
  const ModelSpace* space_;
  std::size_t width_;
  Eigen::VectorXf residual_;
  Eigen::ArrayXf weights_;  ///< softmax weights of the cells, not normalised
  float sum_ = 1.0F;
  bool flat_ = true;  ///< true if there are no residuals; the proposal is then the prior
};

}  // namespace wheeltap::inference
