// When a run's state is handed to its caller.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "inference/engine/checkpoint.hpp"
#include "inference/engine/run_state.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// A run passes safe points: between two iterations of all chains, and between two models that are
/// explored. There its state is all that it is. Saving is left out while it would take more than
/// kShare of the time.
class SafePoints {
 public:
  explicit SafePoints(const Options& options) : options_(options.checkpoints) {}

  /// Chains are to leave their work at the next iteration. Any thread may ask.
  [[nodiscard]] bool due() const { return options_.save && Clock::now() >= next_; }
  /// The state is at a safe point: saves it if that is due. Else remembers it, at most once a
  /// second, for a run that is stopped before the next.
  void pass(RunState& state);
  /// The state is at a safe point, and the run is being stopped.
  void stop(RunState& state);
  /// The run has been stopped wherever it was: saves the last point it passed, unless that or a
  /// later one is saved already.
  void stopped();
  /// Adds the time since it was last asked to the run's own.
  void clock(RunState& state);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kShare = 0.03;

  /// Parts of the draws that are whole and not kept yet. Returns how many of each chain are kept.
  [[nodiscard]] std::vector<std::size_t> hand_over_draws(RunState& state) const;
  /// The state but for those.
  [[nodiscard]] Checkpoint rest_of(RunState& state) const;
  void save(const Checkpoint& checkpoint);

  const Options::Checkpoints& options_;
  Clock::time_point clocked_ = Clock::now();
  Clock::time_point next_ = clocked_ + seconds(options_.every_seconds);
  Clock::time_point remembered_{};
  std::optional<Checkpoint> last_;  ///< passed and not saved

  [[nodiscard]] static Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }
};

}  // namespace wheeltap::inference
