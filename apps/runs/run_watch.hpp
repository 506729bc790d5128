// Who watches a run: a terminal with its log and checkpoints, or another program.
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

  /// Runs the engine. All chains of what it returns are of one length.
  virtual inference::Posterior sample(const inference::Problem& problem,
                                      inference::Options options) = 0;
  /// Work before the engine's: `fraction` of `stage` is done; `clear` once all of it is. What it
  /// throws ends the work.
  virtual void show(const char* stage, double fraction, const std::string& detail) = 0;
  virtual void clear() {}
  /// Lines for people.
  virtual void note(const std::string& line) = 0;
  virtual void warn(const std::string& line) = 0;
  /// Whether work beside the engine's is to be left.
  [[nodiscard]] virtual bool stopped() const = 0;

  /// A system identification is repeated with better steps from here on.
  virtual void repeat(const identification::StepsRefined& /*refined*/) {}
  /// With which it was being repeated where it is taken up.
  [[nodiscard]] virtual std::optional<identification::StepsRefined> refined() const { return {}; }
};

}  // namespace wheeltap::apps
