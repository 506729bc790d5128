// What a run of the engine may be told: nothing has to be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace wheeltap::inference {

struct Checkpoint;  // checkpoint.hpp

/// 0 means, wherever it is allowed, that the engine chooses.
struct Options {
  std::uint64_t seed = 1;
  int chains = 4;
  int threads = 0;  ///< 0: as many as the machine has. Never changes a result.
  int warmup = 0;   ///< iterations a chain; 0: chosen by the engine, with what a good start takes
  int draws = 0;  ///< kept a chain, after warm-up; 0: 25 000, extended until the run has converged
  int thin = 0;   ///< iterations a draw; 0: chosen by the engine
  /// A look, not a posterior: few climbs, importance sampling from their modes, short chains; fixed
  /// work, where `warmup`, `draws`, `thin` and `searches` leave it to the engine. Never converged.
  bool quick = false;
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

  /// Where draws are kept while they are made, if there are so many that memory should not hold
  /// them (DrawMemory); empty: in memory all the same. Never changes a result.
  std::filesystem::path draws_folder = {};

  struct Progress {
    const char* stage;  ///< "exploring", "sampling" …
    double fraction;    ///< of the stage
    long likelihood_evaluations;
    /// Calls that the stages after this one will take, as far as that is planned.
    double evaluations_to_come;
    std::vector<double> model_probabilities;  ///< so far; empty during warm-up
  };
  /// Called from one thread at a time, a few times a second. Returning false stops the run early:
  /// what has been drawn is kept, and before anything was, draws of what the searches have found.
  std::function<bool(const Progress&)> progress = nullptr;
  /// Asked between two likelihoods, by any thread: true once the run is to stop. An expensive
  /// likelihood then delays the end by a few calls, not until the next call of `progress`. It must
  /// stay true.
  std::function<bool()> stop = nullptr;

  /// What a run can be taken up again from, bit for bit.
  struct Checkpoints {
    /// Called from one thread, between two iterations of all chains: every so many seconds, and
    /// once where the run is stopped early. Its time is kept below 3 % of the run's.
    std::function<void(const Checkpoint&)> save = nullptr;
    double every_seconds = 0.0;  ///< 0: wherever a run can be left
    /// Goes on from there. Problem, seed and all options but threads and callbacks must be those
    /// that it was saved with.
    std::shared_ptr<const Checkpoint> from = nullptr;

    // Saving all draws again and again takes time and memory where there are many. With these, so
    // many of a chain at a time are saved apart, once, and what `save` is given goes without them;
    // a part is needed until a checkpoint is saved that has a later first part
    // (inference::parts_of).
    /// Part `number`; false where it could not be kept, and is to be offered again.
    std::function<bool(const Checkpoint& draws, long number)> save_draws = nullptr;
    std::function<Checkpoint(long number)> saved_draws = nullptr;  ///< for `from`
    int part = 1 << 16;                                            ///< draws of a chain
  };
  Checkpoints checkpoints{};
};

}  // namespace wheeltap::inference
