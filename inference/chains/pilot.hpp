// Warm-up: starts the chains at draws from the priors and fits the proposals to posterior samples.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "inference/chains/tempering.hpp"
#include "inference/moves/between_models/component_proposal.hpp"
#include "inference/moves/between_models/conditional_proposal.hpp"
#include "inference/moves/differential_evolution.hpp"
#include "inference/moves/mixture_jump.hpp"
#include "inference/moves/move.hpp"
#include "inference/moves/random_walk.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Tables of the effects of single components, one table per component kind (null: no table). The
/// tables are computed once and shared by all chains.
using Atlases = std::vector<std::shared_ptr<const EffectAtlas>>;
[[nodiscard]] Atlases make_atlases(const Problem& problem, const Options& options,
                                   long& evaluations);

/// Kernels that need no pilot samples: random walk, birth and death, relocation, reflection, model
/// switch.
[[nodiscard]] std::unique_ptr<KernelMixture> exploration_kernels(const Problem& problem,
                                                                 const Options& options,
                                                                 const Atlases& atlases);

struct CheckpointFields;  // checkpoint.cpp

/// States of a chain in warm-up: one list per model, thinned to a few thousand states.
class PilotSamples {
 public:
  explicit PilotSamples(const ModelSpace& space);
  void add(const State& state);
  /// Appends another chain's samples.
  void append(const PilotSamples& other);
  [[nodiscard]] long visits(int model) const { return visits_[static_cast<std::size_t>(model)]; }
  [[nodiscard]] long total() const;
  /// The stored states of a model, one per column: dimension × n.
  [[nodiscard]] Eigen::MatrixXd states(int model) const;

 private:
  friend struct CheckpointFields;
  PilotSamples() = default;

  static constexpr std::size_t kKeep = 4000;
  struct OfModel {
    std::size_t dimension = 0;
    std::vector<double> values;
    long stride = 1;
  };
  std::vector<OfModel> models_;
  std::vector<long> visits_;
};

/// Proposals fitted to the pilot samples of all chains; fixed when sampling starts.
struct Pilot {
  std::shared_ptr<const PilotFit> fit;
  std::shared_ptr<const Archive> archive;
  /// One element per component kind
  std::vector<std::shared_ptr<const ConditionalMixtures>> conditionals;
  RandomWalk::Scales scales;
  /// Efficiency of each kernel (kernel_efficiencies); empty before the efficiencies are estimated.
  std::vector<double> efficiencies;
};

/// Options of the fit of the proposals. `by_rung[i]` holds the samples at the i-th temperature, the
/// coldest last. If a model has too few samples at the coldest temperature, its proposal is fitted
/// to samples at higher temperatures. If a model has no samples at all, its proposal is fitted to
/// the prior.
struct PilotOptions {
  std::uint64_t seed = 1;
  int round = 0;
  int threads = 0;
  Eigen::Index most_samples = 8000;  ///< largest number of samples in the fit of a mixture
  int most_components = 20;          ///< largest number of components of a mixture
  double tolerance = 1e-7;  ///< tolerance of a mixture's last EM fit: mean log density per sample
  /// Additional posterior samples of each model, for example from regions that the chains may not
  /// have visited. The list may be empty.
  std::vector<Eigen::MatrixXd> besides{};
  /// Probability of each model. If the list is empty, the fraction of visits to each model at the
  /// coldest temperature is used instead.
  std::vector<double> probability{};
  /// Posterior modes of each model, found by the mode searches. A posterior mode that the fitted
  /// mixture does not cover is added to the mixture.
  std::vector<std::vector<NormalMixture::Component>> modes{};
};
[[nodiscard]] Pilot fit_pilot(const ModelSpace& space, const std::vector<PilotSamples>& by_rung,
                              const PilotOptions& options);

/// Log weights with which the chains visit all models whose probability is at least `least` about
/// equally often. Less probable models get the weight of a model with the probability `least`.
/// Every model then has enough samples to fit its proposal.
[[nodiscard]] std::vector<double> equal_visits_bias(const std::vector<double>& probability,
                                                    double least);

/// Regions of the posterior for which the MCMC steps are designed. With `fitted`, these are mostly
/// the regions that the fitted proposals cover. With `tuning`, which applies while proposals are
/// fitted, they include other regions. With `beyond`, additional slice sampling also reaches
/// regions that the fitted proposals cannot cover, such as heavy tails.
enum class Reach { fitted, tuning, beyond };

/// All kernels, including those with pilot proposals.
[[nodiscard]] std::unique_ptr<KernelMixture> sampling_kernels(const Problem& problem,
                                                              const Options& options,
                                                              const Atlases& atlases,
                                                              const Pilot& pilot,
                                                              Reach reach = Reach::fitted);

}  // namespace wheeltap::inference
