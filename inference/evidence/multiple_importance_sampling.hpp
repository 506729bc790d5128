// Adaptive multiple importance sampling of one model's posterior.
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
/// Statistics 39:798). In round r, n_r draws are made from the proposal q_r. The draws of all
/// rounds are weighted by the mixture of all proposals,
///
///   w(z) ∝ π(z) / Σ_r n_r q_r(z),   Z ≈ Σ_i w(z_i),
///
/// the balance heuristic of Owen & Zhou (2000, J. American Statistical Association 95:135).
class MultipleImportanceSampler {
 public:
  /// The sampler keeps a reference to `problem`. Draws depend on the seed and not on the number of
  /// threads. Any thread may call `stop` between two likelihood evaluations. Once `stop` returns
  /// true, the sample is invalid.
  MultipleImportanceSampler(const Problem& problem, int model, std::uint64_t seed, int threads,
                            std::function<bool()> stop = nullptr)
      : problem_(problem), model_(model), seed_(seed), threads_(threads), stop_(std::move(stop)) {}

  /// Adds n draws from `proposal` and recomputes all weights.
  void add(const NormalMixture& proposal, int n);

  [[nodiscard]] double effective_draws() const { return effective_; }
  /// Effective sample size divided by the number of draws.
  [[nodiscard]] double efficiency() const;
  [[nodiscard]] long evaluations() const { return evaluations_; }
  /// Normalised weights of the draws. All weights are 0 if no draw has a positive posterior
  /// density.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] std::span<const double> z(std::size_t i) const;
  /// Evidence by importance sampling; NaN for one effective draw or fewer.
  [[nodiscard]] Evidence evidence() const;
  /// ln density of the mixture of all proposals, each weighted by its number of draws.
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
  double log_mean_ = 0.0;  // ln Z, valid if a draw has a positive posterior density
  long evaluations_ = 0;
};

}  // namespace wheeltap::inference
