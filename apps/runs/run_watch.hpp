// Interface of the observer of a run: a terminal with log and checkpoints, or another program.
#pragma once

#include <optional>
#include <string>

#include "identification/sid/sid_run.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::apps {

class RunWatch {
 public:
  RunWatch() = default;
  RunWatch(const RunWatch&) = delete;
  RunWatch& operator=(const RunWatch&) = delete;
  virtual ~RunWatch() = default;

  /// Runs the engine. All returned chains have the same length.
  virtual inference::Posterior sample(const inference::Problem& problem,
                                      inference::Options options) = 0;
  /// Reports the progress of the work before sampling: `fraction` of `stage` is done. Call `clear`
  /// at the end of the work. An exception from this function stops the work.
  virtual void show(const char* stage, double fraction, const std::string& detail) = 0;
  virtual void clear() {}
  /// Shows a line to the user.
  virtual void note(const std::string& line) = 0;
  virtual void warn(const std::string& line) = 0;
  /// True if work outside the engine should stop.
  [[nodiscard]] virtual bool stopped() const = 0;

  /// Called when a system identification is repeated with smaller time steps.
  virtual void repeat(const identification::StepsRefined& /*refined*/) {}
  /// If a resumed run was stopped during such a repetition, returns the time steps of the
  /// repetition.
  [[nodiscard]] virtual std::optional<identification::StepsRefined> refined() const { return {}; }
};

}  // namespace wheeltap::apps
