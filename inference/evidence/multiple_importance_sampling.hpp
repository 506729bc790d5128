// Importance sampling of one model's posterior by several proposals, each made from what those
// before it found.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/eigen.hpp"
#include "base/random.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// Adaptive multiple importance sampling (Cornuet, Marin, Mira & Robert 2012, Scandinavian J.
/// Statistics 39:798): draws of all rounds r, n_r from proposal q_r, are weighted against the
/// mixture of all proposals,
///
///   w(z) ∝ π(z) / Σ_r n_r q_r(z),   Z ≈ Σ_i w(z_i),
///
/// the balance heuristic of Owen & Zhou (2000, J. American Statistical Association 95:135).
class MultipleImportanceSampler {
 public:
  /// Keeps a reference to `problem`. Draws depend on the seed alone, not on the threads.
  /// `stop` is asked between likelihoods, by any thread: once it is true, the sample is worthless.
  MultipleImportanceSampler(const Problem& problem, int model, std::uint64_t seed, int threads,
                            std::function<bool()> stop = nullptr)
      : problem_(problem), model_(model), seed_(seed), threads_(threads), stop_(std::move(stop)) {}

  /// n more draws, of this proposal; all weights are renewed.
  void add(const NormalMixture& proposal, int n);

  [[nodiscard]] double effective_draws() const { return effective_; }
  /// Effective draws, a draw.
  [[nodiscard]] double efficiency() const;
  [[nodiscard]] long evaluations() const { return evaluations_; }
  /// Of sum 1; all of them 0 where no draw is possible.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] std::span<const double> z(std::size_t i) const;
  /// NaN unless more than one draw is effective.
  [[nodiscard]] Evidence evidence() const;
  /// ln of the mixture of all proposals, each counted as often as it was drawn from.
  [[nodiscard]] double log_proposal(std::span<const double> z) const;
  /// Equally weighted draws by systematic resampling, n × d.
  [[nodiscard]] Eigen::MatrixXd resampled(Eigen::Index n, base::Random& random) const;

 private:
  void weigh(std::size_t total);

  const Problem& problem_;
  int model_;
  std::uint64_t seed_;
  int threads_;
  std::function<bool()> stop_;
  std::vector<double> z_, log_posterior_, log_proposals_, weights_;
  std::vector<NormalMixture> proposals_;
  std::vector<int> sizes_;
  double effective_ = 0.0;
  double log_mean_ = 0.0;  // ln Z where a draw is possible
  long evaluations_ = 0;
};

}  // namespace wheeltap::inference
