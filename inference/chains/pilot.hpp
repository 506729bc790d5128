// Warm-up: from priors alone to proposals that fit the posterior.
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

/// What is computed once and shared by every chain: the effects of single components, a kind each
/// (null where there are none).
using Atlases = std::vector<std::shared_ptr<const EffectAtlas>>;
[[nodiscard]] Atlases make_atlases(const Problem& problem, const Options& options,
                                   long& evaluations);

/// The kernels that need no pilot: random walk, births and deaths, relocation, mirrors, model
/// switches.
[[nodiscard]] std::unique_ptr<KernelMixture> exploration_kernels(const Problem& problem,
                                                                 const Options& options,
                                                                 const Atlases& atlases);

struct CheckpointFields;  // checkpoint.cpp

/// States met in warm-up, by model: columns are states, thinned to a few thousand.
class PilotSamples {
 public:
  explicit PilotSamples(const ModelSpace& space);
  void add(const State& state);
  /// Appends another chain's samples.
  void append(const PilotSamples& other);
  [[nodiscard]] long visits(int model) const { return visits_[static_cast<std::size_t>(model)]; }
  [[nodiscard]] long total() const;
  /// The kept states of a model, dimension × n.
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

/// What the pilots of all chains amount to; frozen when sampling starts.
struct Pilot {
  std::shared_ptr<const PilotFit> fit;
  std::shared_ptr<const Archive> archive;
  std::vector<std::shared_ptr<const ConditionalMixtures>> conditionals;  ///< one a kind
  RandomWalk::Scales scales;
  std::vector<double> efficiencies;  ///< of each kernel (kernel_efficiencies); {}: not known yet
};

/// Fits the proposals. `by_rung[i]` holds the samples at the i-th temperature, the coldest last: a
/// model with too few cold samples is fitted to warmer ones, and to its prior where there are none.
struct PilotOptions {
  std::uint64_t seed = 1;
  int round = 0;
  int threads = 0;
  Eigen::Index most_samples = 8000;  ///< that a mixture is fitted to
  int most_components = 20;          ///< of a mixture
  double tolerance = 1e-7;           ///< of its last fit, in the mean log density of a sample
  /// Samples of each model's posterior that the chains may not have met since; {}: none.
  std::vector<Eigen::MatrixXd> besides{};
  /// P of each model as far as it is known, one a model; {}: the share of the coldest visits.
  std::vector<double> probability{};
  /// Each model's modes as the searches found them; one that the mixture does not cover is added
  /// to it.
  std::vector<std::vector<NormalMixture::Component>> modes{};
};
[[nodiscard]] Pilot fit_pilot(const ModelSpace& space, const std::vector<PilotSamples>& by_rung,
                              const PilotOptions& options);

/// The bias under which all models of at least this probability are visited about equally often,
/// and the others no more than that makes them: a proposal for a model can only be as good as its
/// samples.
[[nodiscard]] std::vector<double> equal_visits_bias(const std::vector<double>& probability,
                                                    double least);

/// All the kernels, the pilot's among them. While the proposals are still `tuning`, more of the
/// steps find what those lack.
[[nodiscard]] std::unique_ptr<KernelMixture> sampling_kernels(const Problem& problem,
                                                              const Options& options,
                                                              const Atlases& atlases,
                                                              const Pilot& pilot,
                                                              bool tuning = false);

}  // namespace wheeltap::inference
