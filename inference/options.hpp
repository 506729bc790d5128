// Options of a run; all have defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace wheeltap::inference {

struct Checkpoint;  // checkpoint.hpp

/// For some options, the value 0 means that the engine chooses the value.
struct Options {
  std::uint64_t seed = 1;
  int chains = 4;
  int threads = 0;  ///< number of threads; 0: all threads of the machine. The results do not depend
                    ///< on this number.
  /// Warm-up iterations per chain. With 0, the engine chooses the number and also searches for
  /// starting points.
  int warmup = 0;
  /// Draws per chain after warm-up. With 0, the engine starts with 25 000 draws and extends them
  /// until the run has converged.
  int draws = 0;
  int thin = 0;  ///< iterations per draw; 0: the engine chooses
  /// Quick run: few local optimisations, importance sampling from the posterior modes found, short
  /// chains. The number of evaluations is fixed unless `warmup`, `draws`, `thin` or `searches` is
  /// given. The result of a quick run never counts as converged.
  bool quick = false;
  /// True: run without likelihood; the resulting posterior must equal the prior
  bool prior_only = false;

  /// Moves that the engine may use.
  struct Moves {
    bool birth_death = true;
    bool informed_birth = true;
    bool random_walk = true;
    bool relocation = true;
    bool reflection = true;
    bool independence = true;  ///< jumps within and between models, proposed from fitted mixtures
    bool tempering = true;     ///< parallel tempering during warm-up
  };
  Moves moves{};

  /// True: the draws also use parallel tempering, with the temperature ladder from warm-up. If
  /// `draws` is 0, the engine enables tempering when the chains disagree without tempering.
  bool tempered_draws = false;

  /// Number of local optimisations in each model, each from a draw of its prior. If 0, the engine
  /// chooses the number such that the optimisations use a fixed fraction of the run's likelihood
  /// evaluations. If the basin of a posterior mode has the prior probability p, all n local
  /// optimisations miss the mode with probability (1 - p)^n; see `Verdict::resolution`.
  int searches = 0;

  /// Sample with model weights that make all models about equally probable, and reweight the draws
  /// (Posterior::log_weight). Small probabilities then also have small relative errors.
  bool balance = false;

  /// False: do not compute the evidences of models and the probability masses of posterior modes
  /// (NaN), for a caller that needs only draws. The exploration then has at most three rounds of
  /// importance sampling per model, and two local optimisations from draws of the parallel
  /// tempering. These results suffice for starting points and proposals.
  bool evidences = true;

  /// Folder for draws that do not fit into memory (DrawMemory); empty: all draws are kept in
  /// memory. This option does not change results.
  std::filesystem::path draws_folder = {};

  struct Progress {
    const char* stage;  ///< "exploring", "sampling" …
    double fraction;    ///< completed fraction of the stage
    long likelihood_evaluations;
    /// Planned likelihood evaluations of the later stages.
    double evaluations_to_come;
    std::vector<double> model_probabilities;  ///< current model probabilities; empty during warm-up
  };
  /// Callback, called from one thread at a time, a few times per second. If the callback returns
  /// false, the run stops early and keeps its draws. If each chain has fewer than 100 draws, the
  /// result has approximate draws from the mode searches instead (salvage.hpp).
  std::function<bool(const Progress&)> progress = nullptr;
  /// Callback, called between two likelihood evaluations by any thread. The callback returns true
  /// if the run should stop, and must return true in all later calls. With an expensive likelihood,
  /// the run stops after a few evaluations instead of at the next call of `progress`.
  std::function<bool()> stop = nullptr;

  /// Options for saving a run and resuming it with identical results.
  struct Checkpoints {
    /// Callback that saves the state, called from one thread between two iterations of all chains.
    /// The engine calls `save` at the given time interval and once when the run is stopped early.
    /// Saving takes at most 3 % of the run time.
    std::function<void(const Checkpoint&)> save = nullptr;
    double every_seconds = 0.0;  ///< time between two calls of `save` [s]; 0: at every safe point
    /// State to resume from. Problem, seed and all options except threads and callbacks must be
    /// those of the saved run.
    std::shared_ptr<const Checkpoint> from = nullptr;

    // Saving many draws repeatedly takes time and memory. The following callbacks therefore save
    // the draws of a chain in parts of `part` draws, each part once. The checkpoints passed to
    // `save` omit the draws in saved parts. Keep a saved part until `save` has received a
    // checkpoint that begins with a later part (inference::parts_of).
    /// Saves part `number` of the draws. Returns false if saving failed and the engine should try
    /// again later.
    std::function<bool(const Checkpoint& draws, long number)> save_draws = nullptr;
    /// Loads a saved part of the draws, for a run resumed with `from`
    std::function<Checkpoint(long number)> saved_draws = nullptr;
    /// Number of draws of a chain in one part
    int part = 1 << 16;
  };
  Checkpoints checkpoints{};
};

}  // namespace wheeltap::inference
