// A run between two rounds, as a value: what a checkpoint writes and what ranks exchange.
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

/// A chain on its way through a stage whose kernels learn.
struct Lesson {
  int steps = 0;  ///< of this round: of tuning, or scans of a ladder
  // Tempering alone:
  bool begun = false;
  bool ended = false;
  int round_scans = 0;  ///< of this round in all
  int scans = 0;        ///< of the rounds before
  double barrier = 0.0;
  std::vector<std::vector<double>> learnt{};  ///< KernelMixture::learnt: of each rung, or one
};

/// One chain. Its target and kernels are made of this and of the run's state for each round
/// (run_context.hpp): what a kernel has learnt in the midst of a round stands in `lesson`.
struct ChainState {
  State state;                     ///< where it is
  long iteration = 0;              ///< steps that draws were made with: the key of the next one
  Target::Memory target{};         ///< what its target has counted
  std::optional<Ladder> ladder{};  ///< where it has been tempered
  std::vector<PilotSamples> by_rung{};  ///< met in the last round, at each temperature
  std::vector<int> models{};            ///< visited in the last round of tuning
  std::vector<KernelRecord> records{};  ///< of each kernel, in the last round of tuning
  std::optional<KeptDraws> kept{};      ///< a part of its draws, in standard normal coordinates
  std::vector<std::vector<long>> at_mode{};  ///< draws nearest to each mode of each model
  std::vector<MoveStatistics> moves{};       ///< after warm-up
  std::vector<std::vector<long>> proposed{}, accepted{};  ///< jumps, models × models
  Lesson lesson{};
};

/// Where a run is: what it does next. A stage's own work between two of these is done again from
/// the first of them, to the same end.
struct Position {
  enum class Stage { explore, tune, sample };
  enum class Explore { begin, glance, look, search, anneal };
  enum class Sample { begin, ladder, prepare, settle, draw };

  Stage stage = Stage::explore;
  bool tempering = false;  ///< chains are on their way through temper()

  Explore explore = Explore::begin;
  std::vector<int> models{};                               ///< that are searched, or glanced at
  int model = 0;                                           ///< of these: the next one
  double best = -std::numeric_limits<double>::infinity();  ///< ln P Z of the models searched so far
  int look = 0;                                            ///< at many models: round
  int looks_left = 0;                                      ///< models
  std::vector<double> before{};  ///< ln π at the highest mode of each model before this look

  int round = 0;  ///< of tuning
  int tuned = 0;  ///< steps of the rounds before
  Sample sample = Sample::begin;
  int goal = 0;    ///< draws a chain at the end of this round
  int refits = 0;  ///< of the proposals, to draws

  // Of the parts of the draws that are kept apart (Options::Checkpoints::save_draws):
  long first_part = 0;                ///< number of the first
  std::vector<int> part_chains = {};  ///< the chain that each is of
};

/// The modes of a model whose shares the draws are counted for.
struct WeightyModes {
  std::vector<Mode> modes;
  std::vector<Eigen::MatrixXd> precisions;
  std::vector<double> shares;
};

/// All of a run. Copies are independent: what they share is constant (Pilot's mixtures, Posterior's
/// space). A stage that is given a copy, with the same problem, options and seed, makes the same
/// draws bit for bit.
struct RunState {
  Position at;
  std::vector<ChainState> chains;

  // What exploring found, one a model.
  std::vector<ModelExploration> explorations;
  std::vector<double> log_probability;  ///< up to a constant, as far as is known
  std::vector<double> probability;      ///< the same, normalised
  std::vector<PilotSamples> by_rung;    ///< of all chains' ladders, the coldest last

  // What tuning learnt.
  Pilot pilot;
  std::vector<double> tuning_bias;    ///< ln, of each model, of the last round
  std::vector<double> sampling_bias;  ///< the same of the draws: zeros, or what balances them

  // What the draws have come to.
  std::vector<WeightyModes> weighty_modes;
  std::vector<std::vector<double>> at_mixture;  ///< ln π - ln q at draws of each model's mixture
  Posterior posterior;
  long shared_evaluations = 0;  ///< of the likelihood, by no chain in particular
};

}  // namespace wheeltap::inference
