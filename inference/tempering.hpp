// Non-reversible parallel tempering between the prior and the posterior.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "inference/move.hpp"

namespace wheeltap::inference {

/// One chain's ladder of replicas at inverse temperatures 0 = β_0 < … < β_N = 1, each targeting
///
///   π_i(m, z) ∝ e^{w_i(m)} · prior(m, z) · likelihood^{β_i}.
///
/// The lowest draws model and parameters afresh from the prior (w_0 = 0). Neighbours swap on
/// alternating even and odd pairs, the deterministic scheme of Syed et al. (2022, section 2), in
/// which round trips do not slow down as the ladder grows.
///
/// The weights w_i(m) keep every model in sight at every temperature: a model whose tempered
/// evidence dips on the way would otherwise be lost on a joint path, however probable it is at its
/// end. They are learnt by stochastic approximation while adapting (Liang, Liu & Carroll 2007, JASA
/// 102:305: w(m) falls by γ_t where the replica is in m, with γ_t = t₀ / max(t₀, t)) and fixed
/// after.
class TemperedChain {
 public:
  /// Makes the kernels of one rung.
  using KernelFactory = std::function<std::unique_ptr<KernelMixture>()>;

  TemperedChain(Target& target, std::vector<double> betas, KernelFactory kernels,
                std::uint64_t seed, int chain);

  /// Starts every replica from the prior. Throws LikelihoodError where no draw of 100 000
  /// has a finite likelihood.
  void start();
  /// What happened in one kernel step at β = 1.
  using Observer = std::function<void(int kernel, const Kernel::Outcome& outcome, int from_model)>;

  /// Learns weights from now on, whenever a scan adapts.
  void balance_models() { balancing_ = true; }
  /// w of the coldest rung: zeros where the posterior itself is wanted there.
  void set_cold_weights(const std::vector<double>& weights) { weights_.back() = weights; }
  [[nodiscard]] const std::vector<double>& cold_weights() const { return weights_.back(); }
  /// Puts replicas at the warm end's states where they are not impossible: the coldest rung first.
  void set_cold(const State& state) { states_.back() = state; }

  /// `steps` kernel steps in every rung, then one round of swaps.
  void scan(int steps, bool adapting, base::Purpose purpose, const Observer& observe = nullptr);

  /// Other kernels from now on, for every rung.
  void set_kernels(KernelFactory kernels);

  /// Moves the ladder so that neighbours reject swaps equally often (ibid., algorithm 4), with
  /// `rungs` rungs, from the rejections since the last call. Replicas keep their rung or its
  /// nearest.
  void adapt_ladder(int rungs);
  /// Σ of the neighbours' rejection rates since the last adaptation: the communication barrier Λ.
  [[nodiscard]] double barrier() const;

  [[nodiscard]] const std::vector<double>& betas() const { return betas_; }
  [[nodiscard]] int rungs() const { return static_cast<int>(betas_.size()); }
  [[nodiscard]] const State& state(int rung) const {
    return states_[static_cast<std::size_t>(rung)];
  }
  [[nodiscard]] const State& cold() const { return states_.back(); }
  [[nodiscard]] const KernelMixture& cold_kernels() const { return *kernels_.back(); }
  /// Trips of a replica from β = 0 to β = 1 and back, completed since the last reset.
  [[nodiscard]] long round_trips() const { return round_trips_; }
  void reset_round_trips();

 private:
  Target& target_;
  std::vector<double> betas_;
  KernelFactory factory_;
  std::uint64_t seed_;
  int chain_;
  std::vector<State> states_;
  std::vector<std::unique_ptr<KernelMixture>> kernels_;
  std::vector<double> rejection_;  ///< Σ (1 - α) of each pair
  std::vector<long> tried_;
  std::vector<int> direction_;                ///< of each replica: +1 since β = 0, -1 since β = 1
  std::vector<int> replica_;                  ///< which replica is at each rung
  std::vector<std::vector<double>> weights_;  ///< of each rung, one a model
  bool balancing_ = false;
  long scans_ = 0;
  long round_trips_ = 0;
};

/// A first ladder: 0, then `rungs` - 1 values from 10⁻⁵ to 1 in equal ratios.
[[nodiscard]] std::vector<double> geometric_ladder(int rungs);

/// A state drawn from the prior whose likelihood is finite. Throws LikelihoodError after 100 000
/// tries.
[[nodiscard]] State start_from_prior(Target& target, base::Random& random);

/// Throws LikelihoodError, naming the model, for a model with prior weight whose likelihood is
/// finite at none of 100 000 draws from its prior (5000 where the problem can be shortened: all
/// but the first 200 by its first 50 samples, before the whole). Stops at the first finite one.
void check_models(Target& target, std::uint64_t seed);

}  // namespace wheeltap::inference
