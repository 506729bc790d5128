// State of a run between two rounds, stored in checkpoints and exchanged between ranks.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/chains/kept_draws.hpp"
#include "inference/chains/pilot.hpp"
#include "inference/chains/tempering.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "inference/exploration/model_exploration.hpp"
#include "inference/model/target.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Progress of a chain in a stage with adaptive kernels.
struct AdaptationState {
  int steps = 0;  ///< completed steps of this tuning round, or scans of a ladder
  // Used by parallel tempering only:
  bool begun = false;
  bool ended = false;
  int round_scans = 0;  ///< total number of scans of this round
  int scans = 0;        ///< total number of scans of the earlier rounds
  double barrier = 0.0;
  /// Adaptation state of the kernels (KernelMixture::learnt): one list per rung, or a single list
  /// without tempering.
  std::vector<std::vector<double>> learnt{};
};

/// State of one chain. The chain's target and kernels are rebuilt from ChainState and RunState in
/// each round (run_context.hpp). `adaptation` stores the adaptation state of the kernels within a
/// round.
struct ChainState {
  State state;  ///< current state of the chain
  /// Number of sampling steps so far; the next random numbers depend on this number.
  long iteration = 0;
  Target::Memory target{};              ///< counters of the chain's target
  std::optional<Ladder> ladder{};       ///< ladder of replicas, for a tempered chain
  std::vector<PilotSamples> by_rung{};  ///< states of the last round at each temperature
  std::vector<int> models{};            ///< models visited in the last round of tuning
  std::vector<KernelRecord> records{};  ///< statistics of each kernel in the last round of tuning
  /// A subset of the chain's draws, in standard normal coordinates
  std::optional<KeptDraws> kept{};
  std::vector<std::vector<long>> at_mode{};  ///< number of draws nearest to each posterior mode of
                                             ///< each model
  std::vector<MoveStatistics> moves{};       ///< statistics of each move after warm-up
  /// Numbers of proposed and accepted jumps between models after warm-up, models × models.
  std::vector<std::vector<long>> proposed{}, accepted{};
  AdaptationState adaptation{};
};

/// Position in the run: the next step to be executed. A resumed run repeats the work after the last
/// stored position with the same result.
struct Position {
  enum class Stage { explore, tune, sample };
  enum class Explore { begin, climb, look, search, anneal };
  enum class Sample { begin, ladder, prepare, settle, draw };

  Stage stage = Stage::explore;
  bool tempering = false;  ///< the chains are inside temper()

  Explore explore = Explore::begin;
  /// Models that await a full search, or a search by local optimisations alone
  std::vector<int> models{};
  int model = 0;  ///< index of the next model in `models`
  /// ln (P Z) of the best model searched so far; P is the prior probability of the model, Z its
  /// evidence.
  double best = -std::numeric_limits<double>::infinity();
  int look = 0;                  ///< round of local optimisations in many models
  int looks_left = 0;            ///< number of models left in this round
  std::vector<double> before{};  ///< ln π at the highest posterior mode of each model before this
                                 ///< round

  int round = 0;  ///< index of the tuning round
  int tuned = 0;  ///< tuning steps of the earlier rounds
  Sample sample = Sample::begin;
  int goal = 0;    ///< draws per chain at the end of this round
  int refits = 0;  ///< number of fits of the proposals to draws

  // Parts of the draws that are saved separately (Options::Checkpoints::save_draws):
  long first_part = 0;                ///< index of the first separately saved part
  std::vector<int> part_chains = {};  ///< chain of each part
};

/// Posterior modes of one model, for counting the draws near each mode.
struct CountedModes {
  std::vector<Mode> modes;
  std::vector<Eigen::MatrixXd> precisions;
  std::vector<double> shares;
};

/// Complete state of a run. Copies are independent, because shared members (mixtures of Pilot,
/// model space of Posterior) are constant. A stage that starts from a copy, with the same problem,
/// options and seed, produces bitwise the same draws.
struct RunState {
  Position at;
  std::vector<ChainState> chains;

  // Results of the exploration, one per model.
  std::vector<ModelExploration> explorations;
  std::vector<double> log_probability;  ///< log model probabilities up to a constant, if known
  std::vector<double> probability;      ///< normalised model probabilities
  std::vector<PilotSamples> by_rung;    ///< samples of all chains' ladders, the coldest last

  // Results of tuning.
  Pilot pilot;
  std::vector<double> tuning_bias;  ///< ln weight of each model in the last tuning round
  /// ln weight of each model for the draws: zero, or values that make the visits to all models
  /// about equally frequent.
  std::vector<double> sampling_bias;

  // Results of sampling.
  std::vector<CountedModes> weighty_modes;
  std::vector<std::vector<double>> at_mixture;  ///< ln π - ln q at draws of each model's mixture
  Posterior posterior;
  long shared_evaluations = 0;  ///< likelihood evaluations outside the chains
};

}  // namespace wheeltap::inference
