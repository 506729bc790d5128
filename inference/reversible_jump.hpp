// Reversible-jump MCMC over a model space (Green 1995, 2003; Hastie & Green 2012), with no tuning
// asked of its user.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "inference/evidence/model_posterior.hpp"
#include "inference/target.hpp"

namespace wheeltap::inference {

struct Options {
  std::uint64_t seed = 1;
  int chains = 4;
  int threads = 0;  ///< 0: as many as the machine has. Never changes a result.
  int warmup = 0;   ///< iterations a chain; 0: chosen by the engine, with what a good start takes
  int draws = 0;  ///< kept a chain, after warm-up; 0: 25 000, extended until the run has converged
  int thin = 0;   ///< iterations a draw; 0: chosen by the engine
  bool prior_only = false;  ///< switch the likelihood off: the run must return the prior

  /// Which moves may be used; the engine chooses among these.
  struct Moves {
    bool birth_death = true;
    bool informed_birth = true;
    bool random_walk = true;
    bool relocation = true;
    bool reflection = true;
    bool independence = true;  ///< jumps within and between models by fitted mixtures
    bool tempering = true;     ///< parallel tempering during warm-up
  };
  Moves moves{};

  /// Parallel tempering while the draws are made, too, on the ladder that warm-up set. The engine
  /// turns to it by itself where the chains do not agree without it and `draws` is 0.
  bool tempered_draws = false;

  /// Climbs to modes of each model, from as many draws of its prior; 0: chosen by the engine, as
  /// many as a share of the run's likelihood calls pays for. A mode whose basin holds a share p of
  /// the prior is missed by all n with probability (1 - p)^n: `Verdict::resolution`.
  int searches = 0;

  /// Draw from models weighted to be about equally probable, and reweight (Posterior::log_weight):
  /// probabilities far from one half are then known as well as those near it.
  bool balance = false;

  struct Progress {
    const char* stage;  ///< "exploring", "sampling" …
    double fraction;    ///< of the stage
    long likelihood_evaluations;
    std::vector<double> model_probabilities;  ///< so far; empty during warm-up
  };
  /// Called from one thread at a time, a few times a second. Returning false stops the run early;
  /// what has been sampled is kept.
  std::function<bool(const Progress&)> progress = nullptr;
};

/// One chain's kept draws; theta is NaN-padded to the largest dimension, row-major draws ×
/// dimension.
struct Chain {
  std::vector<int> model;
  std::vector<double> theta;      ///< physical parameters, laid out as in Model
  std::vector<double> log_prior;  ///< ln P(model) + Σ ln p(x) + ln factor, in physical units
  std::vector<double> log_likelihood;
  std::vector<std::int16_t> move;  ///< index into Posterior::moves of the last attempted move
  std::vector<std::uint8_t> accepted;
  std::vector<float> prediction;  ///< draws × Posterior::predictions, or empty
};

/// How often a move was tried and accepted after warm-up.
struct MoveStatistics {
  std::string name;
  long proposed = 0;
  long accepted = 0;
};

/// A mode of one model that a search found.
struct FoundMode {
  std::vector<double> x;       ///< physical parameters
  double log_posterior = 0.0;  ///< in standard normal coordinates
  long climbs = 0;             ///< that ended there
  double share = 0.0;          ///< of its model's probability, by importance sampling
  std::vector<double> drawn;   ///< its share of each chain's draws of the model; NaN where none
};

/// What is known of one model beside the draws: searches and evidence.
struct ModelFindings {
  long climbs = 0;               ///< to modes, each from a draw of the prior
  std::vector<FoundMode> modes;  ///< separate ones that matter, the weightiest first
  Evidence annealed =
      kNoEvidence;  ///< by sequential Monte Carlo or the ladder, from the prior; NaN: not run
  Evidence sampled = kNoEvidence;  ///< by importance sampling from the final mixture
  Evidence bridged =
      kNoEvidence;  ///< by bridge sampling between its draws and that mixture; NaN: too few draws
};

/// What a run returns.
struct Posterior {
  const ModelSpace* space = nullptr;  ///< the caller's problem must outlive this
  std::vector<Chain> chains;
  std::vector<ModelFindings> found;  ///< one a model
  /// ln of what a draw of each model counts, one a model; empty: all count the same. Not empty
  /// where `Options::balance` drew models more evenly than they are probable.
  std::vector<double> log_weight;
  std::vector<MoveStatistics> moves;
  std::vector<std::vector<long>> jumps_proposed;  ///< models × models, after warm-up
  std::vector<std::vector<long>> jumps_accepted;
  int draws = 0;   ///< kept a chain
  int warmup = 0;  ///< iterations a chain at β = 1 before the first draw
  int thin = 1;
  int dimension = 0;    ///< row length of Chain::theta
  int predictions = 0;  ///< row length of Chain::prediction
  long warmup_evaluations = 0;
  long likelihood_evaluations = 0;  ///< all of them, warm-up included
  /// Of the likelihood proper where the problem has a stand-in, warm-up included; those above are
  /// then the stand-in's.
  long full_evaluations = 0;
  double wall_seconds = 0.0;
  bool stopped_early = false;
  bool tempered_draws = false;  ///< the draws were made with parallel tempering
  long ladder_round_trips =
      0;                 ///< between β = 0 and β = 1 and back, while drawing, over all chains
  double barrier = 0.0;  ///< Λ of the ladder (Syed et al. 2022), the largest of any chain; 0: none
  long impossible = 0;   ///< likelihoods that were NaN or +∞ and counted as -∞
  std::vector<std::string> notes;  ///< what the engine chose, in words
};

/// Samples the posterior over (model, parameters). Chains start from the prior. Adaptation happens
/// during warm-up only; the kernel that produces the draws is fixed.
[[nodiscard]] Posterior reversible_jump(const Problem& problem, const Options& options);

}  // namespace wheeltap::inference
