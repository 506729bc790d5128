// Options of a run; all have defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace wheeltap::inference {

struct Checkpoint;  // checkpoint.hpp

/// For some options, 0 means that the engine chooses the value.
struct Options {
  std::uint64_t seed = 1;
  int chains = 4;
  int threads = 0;  ///< 0: as many as the machine has. Never changes a result.
  /// Iterations per chain; 0: chosen by the engine, including the search for starting points.
  int warmup = 0;
  int draws = 0;  ///< per chain, after warm-up; 0: 25 000, extended until the run has converged
  int thin = 0;   ///< iterations per draw; 0: chosen by the engine
  /// Quick run: few climbs, importance sampling from their modes, short chains. The work is fixed
  /// unless `warmup`, `draws`, `thin` or `searches` are given. The result never counts as
  /// converged.
  bool quick = false;
  bool prior_only = false;  ///< run without likelihood; the result must be the prior

  /// Moves that the engine may use.
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

  /// Parallel tempering also for the draws, on the ladder of warm-up. If `draws` is 0, the engine
  /// enables it when the chains disagree without it.
  bool tempered_draws = false;

  /// Climbs to modes of each model, each from a draw of its prior; 0: chosen by the engine, for a
  /// fixed share of the run's likelihood calls. If the basin of a mode holds a share p of the
  /// prior, all n climbs miss the mode with probability (1 - p)^n; see `Verdict::resolution`.
  int searches = 0;

  /// Sample with model weights that make all models about equally probable, and reweight the draws
  /// (Posterior::log_weight). Small probabilities then also have small relative errors.
  bool balance = false;

  /// Folder for draws that do not fit into memory (DrawMemory); empty: all draws are kept in
  /// memory. This option does not change results.
  std::filesystem::path draws_folder = {};

  struct Progress {
    const char* stage;  ///< "exploring", "sampling" …
    double fraction;    ///< completed share of the stage
    long likelihood_evaluations;
    /// Planned calls of the later stages.
    double evaluations_to_come;
    std::vector<double> model_probabilities;  ///< so far; empty during warm-up
  };
  /// Called from one thread at a time, a few times per second. Returning false stops the run early.
  /// Existing draws are kept; if there are none, the result has draws based on the mode searches.
  std::function<bool(const Progress&)> progress = nullptr;
  /// Called between two likelihood evaluations by any thread. It returns true if the run should
  /// stop, and must then return true in all later calls. With an expensive likelihood, the run
  /// stops after a few evaluations instead of at the next call of `progress`.
  std::function<bool()> stop = nullptr;

  /// Options for saving a run and resuming it with identical results.
  struct Checkpoints {
    /// Called from one thread, between two iterations of all chains, at the given interval and once
    /// when the run is stopped early. It takes at most 3 % of the run time.
    std::function<void(const Checkpoint&)> save = nullptr;
    double every_seconds = 0.0;  ///< 0: at every safe point
    /// State to resume from. Problem, seed and all options except threads and callbacks must be
    /// those of the saved run.
    std::shared_ptr<const Checkpoint> from = nullptr;

    // Saving many draws repeatedly takes time and memory. With the following callbacks, blocks of
    // `part` draws of a chain are saved once, separately, and the checkpoints passed to `save` omit
    // them. A part must be kept until a checkpoint has been saved whose first part is later
    // (inference::parts_of).
    /// Saves part `number`; returns false if that failed and the engine should try again later.
    std::function<bool(const Checkpoint& draws, long number)> save_draws = nullptr;
    std::function<Checkpoint(long number)> saved_draws = nullptr;  ///< for `from`
    int part = 1 << 16;                                            ///< draws of a chain
  };
  Checkpoints checkpoints{};
};

}  // namespace wheeltap::inference
