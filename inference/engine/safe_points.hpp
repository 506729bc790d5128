// Safe points of a run, at which its state is passed to the caller for saving.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "inference/engine/checkpoint.hpp"
#include "inference/engine/run_state.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Safe points lie between two iterations of all chains and between two explored models. At a safe
/// point, RunState is complete. The time between two saves is long enough that saving takes at most
/// the fraction kShare of the run time.
class SafePoints {
 public:
  explicit SafePoints(const Options& options) : options_(options.checkpoints) {}

  /// True if the chains should pause at the next iteration so that the state can be saved. Safe to
  /// call from any thread.
  [[nodiscard]] bool due() const { return options_.save && Clock::now() >= next_; }
  /// Call this function at every safe point. The function saves the state if saving is due.
  /// Otherwise, the function stores a copy of the state, at most once per second, in case the run
  /// is stopped before the next safe point.
  void pass(RunState& state);
  /// Saves the state. Call this function at a safe point if the run is being stopped.
  void stop(RunState& state);
  /// Saves the state of the last safe point, unless this state or a later one is already saved.
  /// Call this function if the run was stopped between two safe points.
  void stopped();
  /// Adds the time since the last call to the run time of the state.
  void clock(RunState& state);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kShare = 0.03;

  /// Saves the complete parts of the draws that have not been saved. Returns the number of saved
  /// draws of each chain.
  [[nodiscard]] std::vector<std::size_t> hand_over_draws(RunState& state) const;
  /// The state as a checkpoint without the separately saved draws.
  [[nodiscard]] Checkpoint rest_of(RunState& state) const;
  void save(const Checkpoint& checkpoint);

  const Options::Checkpoints& options_;
  Clock::time_point clocked_ = Clock::now();
  Clock::time_point next_ = clocked_ + seconds(options_.every_seconds);
  Clock::time_point remembered_{};
  std::optional<Checkpoint> last_;  ///< state of the last safe point if it is not yet saved

  [[nodiscard]] static Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }
};

}  // namespace wheeltap::inference
