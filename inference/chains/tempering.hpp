// Non-reversible parallel tempering between the prior and the posterior.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// One chain's replicas at inverse temperatures, as a value: what it has met and learnt so far.
struct Ladder {
  std::vector<double> betas;
  std::vector<State> states;                 ///< at each rung
  std::vector<double> rejection{};           ///< Σ (1 - α) of each pair
  std::vector<long> tried{};                 ///< swaps of each pair
  std::vector<int> direction{};              ///< of each replica: +1 since β = 0, -1 since β = 1
  std::vector<int> replica{};                ///< which replica is at each rung
  std::vector<std::vector<double>> weights;  ///< of each rung, one a model
  bool balancing = false;                    ///< weights are learnt whenever a scan adapts
  long scans = 0;
  long round_trips = 0;

  /// Replicas without a state yet, weights of zero.
  Ladder(std::vector<double> inverse_temperatures, int models);

  [[nodiscard]] int rungs() const { return static_cast<int>(betas.size()); }
  /// Forgets what was counted of pairs and replicas.
  void reset_swaps();
  void reset_round_trips();
};

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

  /// Goes on from `ladder`; one that has no states yet needs start().
  TemperedChain(Target& target, Ladder ladder, KernelFactory kernels, std::uint64_t seed,
                int chain);
  TemperedChain(Target& target, std::vector<double> betas, KernelFactory kernels,
                std::uint64_t seed, int chain)
      : TemperedChain(target, Ladder(std::move(betas), target.space().size()), std::move(kernels),
                      seed, chain) {}

  /// Starts every replica from the prior. Throws LikelihoodError where no draw of 100 000
  /// has a finite likelihood.
  void start();
  /// What happened in one kernel step at β = 1.
  using Observer = std::function<void(int kernel, const Kernel::Outcome& outcome, int from_model)>;

  /// Learns weights from now on, whenever a scan adapts.
  void balance_models() { ladder_.balancing = true; }
  /// w of the coldest rung.
  [[nodiscard]] const std::vector<double>& cold_weights() const { return ladder_.weights.back(); }
  /// Puts the replica at β = 1 there.
  void set_cold(const State& state) { ladder_.states.back() = state; }

  /// `steps` kernel steps in every rung, then one round of swaps. `leave`, if any, is asked before
  /// every step; where it says yes the scan ends there: false, and the ladder is good for nothing.
  bool scan(int steps, bool adapting, base::Purpose purpose, const Observer& observe = nullptr,
            const std::function<bool()>& leave = nullptr);

  /// Moves the ladder so that neighbours reject swaps equally often (ibid., algorithm 4), with
  /// `rungs` rungs, from the rejections since the last call. Replicas keep their rung or its
  /// nearest.
  void adapt_ladder(int rungs);
  /// Σ of the neighbours' rejection rates since the last adaptation: the communication barrier Λ.
  [[nodiscard]] double barrier() const;

  [[nodiscard]] const Ladder& ladder() const { return ladder_; }
  /// What each rung's kernels have learnt, and its return (KernelMixture).
  [[nodiscard]] std::vector<std::vector<double>> learnt() const;
  void restore(const std::vector<std::vector<double>>& learnt);
  [[nodiscard]] const std::vector<double>& betas() const { return ladder_.betas; }
  [[nodiscard]] int rungs() const { return ladder_.rungs(); }
  [[nodiscard]] const State& state(int rung) const {
    return ladder_.states[static_cast<std::size_t>(rung)];
  }
  [[nodiscard]] const State& cold() const { return ladder_.states.back(); }
  /// Trips of a replica from β = 0 to β = 1 and back, completed since the last reset.
  [[nodiscard]] long round_trips() const { return ladder_.round_trips; }
  void reset_round_trips() { ladder_.reset_round_trips(); }

 private:
  Target& target_;
  Ladder ladder_;
  KernelFactory factory_;
  std::uint64_t seed_;
  int chain_;
  std::vector<std::unique_ptr<KernelMixture>> kernels_;  ///< one a rung
};

/// A first ladder: 0, then `rungs` - 1 values from 10⁻⁵ to 1 in equal ratios.
[[nodiscard]] std::vector<double> geometric_ladder(int rungs);

/// A state drawn from the prior whose likelihood is finite. Throws LikelihoodError after 100 000
/// tries.
[[nodiscard]] State start_from_prior(Target& target, base::Random& random);

/// Throws LikelihoodError, naming the model, for a model with prior weight whose likelihood is
/// finite at none of 100 000 draws from its prior (5000 where the problem can be shortened: all
/// but the first 200 by its first 50 samples, before the whole). Stops at the first finite one.
/// `goes_on`, if any, is asked before every try, told the share of all that has been tried at most;
/// where it says no, the models that are left are not spoken of.
void check_models(Target& target, std::uint64_t seed,
                  const std::function<bool(double tried)>& goes_on = {});

}  // namespace wheeltap::inference
