// Proposals for the samples of TMCMC, and Metropolis steps with an approximate likelihood.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "inference/mixtures/normal_mixture.hpp"

namespace wheeltap::inference {

/// An approximation of ln prior factor + ln likelihood at z, up to a constant.
using LogApproximation = std::function<double(std::span<const double> z)>;

/// The proposal of a sweep over the samples: draws of the mixture, or steps from the current point
/// with the covariance of a randomly selected component times exp(2 log_scale).
struct SweepProposal {
  const NormalMixture& mixture;
  bool renew = false;  ///< true: draws of the mixture; false: steps
  double log_scale = 0.0;

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
