// Proposals for TMCMC samples, and Metropolis steps with an approximate likelihood.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "inference/mixtures/normal_mixture.hpp"

namespace wheeltap::inference {

/// An approximation of ln prior factor + ln likelihood at z, up to a constant.
using LogApproximation = std::function<double(std::span<const double> z)>;

/// The proposal of a sweep over the samples.
///
/// - A renewal draws from the mixture q.
/// - A walk adds a step with the covariance of a randomly selected component times s². Half of the
///   walks move all coordinates. The other half moves a random subset of the coordinates by longer
///   steps, because in a density with heavy tails, only a few coordinates lie far in the tails.
/// - A contraction selects a component N(μ, L Lᵀ) with the probability that this component
///   generated z. With z = μ + L u, the contraction proposes μ + L (√(1 - s²) u + s ξ) with ξ ~
///   N(0, I). A contraction leaves q invariant, so the acceptance depends only on the error of q
///   (Neal 1998, Bayesian Statistics 6:475; Cotter et al. 2013, Statistical Science 28:424). In
///   many dimensions, a contraction therefore moves farther than a walk, but it moves slowly in
///   regions where q is too small.
struct SweepProposal {
  enum class Kind { renewal, walk, contraction };

  const NormalMixture& mixture;
  Kind kind = Kind::walk;
  double scale = 1.0;  ///< s

  /// Writes a proposal to `to` and returns ln [q(to → z) / q(z → to)]. `normal` is scratch memory
  /// with one entry per dimension.
  double operator()(std::span<const double> z, base::Random& random, std::span<double> normal,
                    std::span<double> to) const;
};

/// Makes Metropolis steps from z that leave φ(z) exp(β s(z)) invariant, where φ is the standard
/// normal density and s the approximation. Updates z and `at` = s(z). Returns the number of
/// accepted steps.
int step_by_approximation(const LogApproximation& approximation, double beta,
                          const SweepProposal& propose, int steps, base::Random& random,
                          std::vector<double>& z, double& at);

}  // namespace wheeltap::inference
