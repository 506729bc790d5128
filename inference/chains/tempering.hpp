// Non-reversible parallel tempering between the prior and the posterior.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// State of the replicas of one chain at all inverse temperatures, with their adapted weights and
/// swap statistics.
struct Ladder {
  std::vector<double> betas;
  std::vector<State> states;        ///< state of the replica at each rung
  std::vector<double> rejection{};  ///< Σ (1 - α) over swaps with acceptance rate α, per pair
  std::vector<long> tried{};        ///< number of attempted swaps of each pair of neighbours
  /// Per replica: +1 if it last visited the end β = 0 of the ladder, -1 if it last visited β = 1
  std::vector<int> direction{};
  std::vector<int> replica{};                ///< index of the replica at each rung
  std::vector<std::vector<double>> weights;  ///< log weights of each rung, one per model
  bool balancing = false;                    ///< true if adaptive scans adapt the model weights
  long scans = 0;
  long round_trips = 0;

  /// Creates a ladder without states and with zero weights.
  Ladder(std::vector<double> inverse_temperatures, int models);

  [[nodiscard]] int rungs() const { return static_cast<int>(betas.size()); }
  /// Resets the counters of swaps and round trips.
  void reset_swaps();
  void reset_round_trips();
};

/// One chain's ladder of replicas at inverse temperatures 0 = β_0 < … < β_N = 1, each targeting
///
///   π_i(m, z) ∝ e^{w_i(m)} · prior(m, z) · likelihood^{β_i}.
///
/// The replica at β = 0 draws model and parameters independently from the prior (w_0 = 0).
/// Neighbouring replicas attempt swaps, alternately in all even and all odd pairs. With this
/// deterministic scheme, longer ladders keep the round-trip rate (Syed et al. 2022).
///
/// The weights w_i(m) let the chain visit every model at every temperature. Without weights, no
/// chain would find a model whose tempered evidence is low at intermediate temperatures, even if
/// this model is probable at β = 1. The weights are adapted by stochastic approximation during
/// warm-up and fixed afterwards (Liang, Liu & Carroll 2007, JASA 102:305). w(m) decreases by γ_t =
/// t₀ / max(t₀, t) when the replica is in model m.
class TemperedChain {
 public:
  /// Creates the kernels of one rung.
  using KernelFactory = std::function<std::unique_ptr<KernelMixture>()>;

  /// Creates a chain that continues from the states of `ladder`. If the ladder has no states, call
  /// start() before the first iteration.
  TemperedChain(Target& target, Ladder ladder, KernelFactory kernels, std::uint64_t seed,
                int chain);
  TemperedChain(Target& target, std::vector<double> betas, KernelFactory kernels,
                std::uint64_t seed, int chain)
      : TemperedChain(target, Ladder(std::move(betas), target.space().size()), std::move(kernels),
                      seed, chain) {}

  /// Starts every replica from the prior. Throws LikelihoodError if none of 100 000 draws has a
  /// positive likelihood.
  void start();
  /// Callback that receives the outcome of each kernel step at β = 1.
  using Observer = std::function<void(int kernel, const Kernel::Outcome& outcome, int from_model)>;

  /// Enables the adaptation of the weights in all later adaptive scans.
  void balance_models() { ladder_.balancing = true; }
  /// Log weights w of the models at the coldest rung (β = 1).
  [[nodiscard]] const std::vector<double>& cold_weights() const { return ladder_.weights.back(); }
  /// Sets the state of the replica at β = 1.
  void set_cold(const State& state) { ladder_.states.back() = state; }

  /// Makes `steps` kernel steps at every rung, then one round of swaps. The function `leave`, if
  /// any, is called before every step. If `leave` returns true, the scan stops and returns false;
  /// the ladder is then invalid.
  bool scan(int steps, bool adapting, base::Purpose purpose, const Observer& observe = nullptr,
            const std::function<bool()>& leave = nullptr);

  /// Sets `rungs` inverse temperatures so that all pairs of neighbouring replicas have equal swap
  /// rejection rates (Syed et al. 2022, algorithm 4). The rates are estimated from the swaps since
  /// the last call. Each replica continues at the nearest rung.
  void adapt_ladder(int rungs);
  /// The communication barrier Λ: the sum of the swap rejection rates of all pairs of neighbours
  /// since the last adaptation.
  [[nodiscard]] double barrier() const;

  [[nodiscard]] const Ladder& ladder() const { return ladder_; }
  /// Adaptation state of the kernels at each rung, to be saved and restored (KernelMixture).
  [[nodiscard]] std::vector<std::vector<double>> learnt() const;
  void restore(const std::vector<std::vector<double>>& learnt);
  [[nodiscard]] const std::vector<double>& betas() const { return ladder_.betas; }
  [[nodiscard]] int rungs() const { return ladder_.rungs(); }
  [[nodiscard]] const State& state(int rung) const {
    return ladder_.states[static_cast<std::size_t>(rung)];
  }
  [[nodiscard]] const State& cold() const { return ladder_.states.back(); }
  /// Number of completed round trips of replicas from β = 0 to β = 1 and back since the last reset.
  [[nodiscard]] long round_trips() const { return ladder_.round_trips; }
  void reset_round_trips() { ladder_.reset_round_trips(); }

 private:
  Target& target_;
  Ladder ladder_;
  KernelFactory factory_;
  std::uint64_t seed_;
  int chain_;
  std::vector<std::unique_ptr<KernelMixture>> kernels_;  ///< one set of kernels per rung
};

/// The initial ladder: 0, then `rungs` - 1 values from 10⁻⁵ to 1 in geometric progression.
[[nodiscard]] std::vector<double> geometric_ladder(int rungs);

/// A draw from the prior with a positive likelihood. Throws LikelihoodError if none of 100 000
/// draws has a positive likelihood.
[[nodiscard]] State start_from_prior(Target& target, base::Random& random);

/// Returns the models with a positive prior probability whose likelihood is zero at each of 100 000
/// draws from their prior (5000 draws if the record can be shortened). After 200 draws, each draw
/// is first tested on the first 50 samples of the record. Throws LikelihoodError, with the name of
/// the first model, if the likelihood of all models is zero at every draw. The optional function
/// `goes_on` is called before every draw with the completed fraction of the maximum number of
/// draws. If `goes_on` returns false, the remaining models are not checked.
std::vector<int> check_models(Target& target, std::uint64_t seed,
                              const std::function<bool(double tried)>& goes_on = {});

}  // namespace wheeltap::inference
