// State of a run between two rounds, as a value: checkpoints store it and ranks exchange it.
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

/// Progress of a chain in a stage whose kernels adapt.
struct AdaptationState {
  int steps = 0;  ///< steps of this tuning round, or scans of a ladder
  // Tempering only:
  bool begun = false;
  bool ended = false;
  int round_scans = 0;  ///< total of this round
  int scans = 0;        ///< total of the earlier rounds
  double barrier = 0.0;
  /// KernelMixture::learnt: one list per rung, or one list.
  std::vector<std::vector<double>> learnt{};
};

/// State of one chain. Its target and kernels are rebuilt from this and from the run's state in
/// each round (run_context.hpp); `adaptation` holds the adaptation state of the kernels within a
/// round.
struct ChainState {
  State state;                     ///< the current state
  long iteration = 0;              ///< steps of sampling so far: key of the next random numbers
  Target::Memory target{};         ///< counters of its target
  std::optional<Ladder> ladder{};  ///< if it was tempered
  std::vector<PilotSamples> by_rung{};  ///< states of the last round at each temperature
  std::vector<int> models{};            ///< visited in the last round of tuning
  std::vector<KernelRecord> records{};  ///< one per kernel, in the last round of tuning
  std::optional<KeptDraws> kept{};      ///< a part of its draws, in standard normal coordinates
  std::vector<std::vector<long>> at_mode{};  ///< draws nearest to each mode of each model
  std::vector<MoveStatistics> moves{};       ///< counted after warm-up
  /// Jumps between models, models × models, after warm-up.
  std::vector<std::vector<long>> proposed{}, accepted{};
  AdaptationState adaptation{};
};

/// Position in the run, that is its next step. A resumed run repeats the work after the last stored
/// position with the same result.
struct Position {
  enum class Stage { explore, tune, sample };
  enum class Explore { begin, climb, look, search, anneal };
  enum class Sample { begin, ladder, prepare, settle, draw };

  Stage stage = Stage::explore;
  bool tempering = false;  ///< the chains are inside temper()

  Explore explore = Explore::begin;
  std::vector<int> models{};  ///< models to be searched, or searched by climbs only
  int model = 0;              ///< index of the next one in `models`
  /// ln (P Z) of the best model searched so far.
  double best = -std::numeric_limits<double>::infinity();
  int look = 0;                  ///< round of climbs in many models
  int looks_left = 0;            ///< models left in this round
  std::vector<double> before{};  ///< ln π at the highest mode of each model before this round

  int round = 0;  ///< of tuning
  int tuned = 0;  ///< steps of the earlier rounds
  Sample sample = Sample::begin;
  int goal = 0;    ///< draws per chain at the end of this round
  int refits = 0;  ///< fits of the proposals to draws

  // Parts of the draws that are saved separately (Options::Checkpoints::save_draws):
  long first_part = 0;                ///< number of the first
  std::vector<int> part_chains = {};  ///< chain of each part
};

/// Modes of a model whose shares of the draws are counted.
struct CountedModes {
  std::vector<Mode> modes;
  std::vector<Eigen::MatrixXd> precisions;
  std::vector<double> shares;
};

/// Complete state of a run. Copies are independent, because shared members (mixtures of Pilot,
/// model space of Posterior) are constant. A stage produces the same draws, bit for bit, from a
/// copy with the same problem, options and seed.
struct RunState {
  Position at;
  std::vector<ChainState> chains;

  // Results of exploration, one per model.
  std::vector<ModelExploration> explorations;
  std::vector<double> log_probability;  ///< up to a constant, where known
  std::vector<double> probability;      ///< the same, normalised
  std::vector<PilotSamples> by_rung;    ///< samples of all chains' ladders, the coldest last

  // Results of tuning.
  Pilot pilot;
  std::vector<double> tuning_bias;  ///< ln weight of each model in the last tuning round
  /// ln weight of each model for the draws: zero, or the weights that balance the models.
  std::vector<double> sampling_bias;

  // Results of sampling.
  std::vector<CountedModes> weighty_modes;
  std::vector<std::vector<double>> at_mixture;  ///< ln π - ln q at draws of each model's mixture
  Posterior posterior;
  long shared_evaluations = 0;  ///< likelihood calls that belong to no chain
};

}  // namespace wheeltap::inference
