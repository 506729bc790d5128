// Work on a thread of its own, so that Python goes on hearing Ctrl-C and progress while it lasts.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "inference/options.hpp"

namespace wheeltap::python {

namespace py = pybind11;

/// What is told of work that lasts.
struct Progress {
  std::string stage;
  double fraction = 0.0;                   ///< of the stage
  long evaluations = 0;                    ///< of the likelihood, so far
  std::vector<double> probabilities = {};  ///< of the models, so far; empty before the draws
};

/// One piece of work, as its own thread sees it.
class Job {
 public:
  /// Whether it is to end as soon as it can. Any thread may ask.
  [[nodiscard]] bool stopped() const { return stop_; }
  void stop() { stop_ = true; }
  /// Hands over what is newest; nobody waits for anybody.
  void tell(Progress progress);

 private:
  friend void watched(const py::object&, const std::function<void(Job&)>&);
  /// Waits until the work has ended (true) or the time is over.
  bool ended_within(std::chrono::milliseconds time);
  [[nodiscard]] std::optional<Progress> news();

  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::optional<Progress> news_;
};

/// Calls work(job) on a thread with the GIL released, and waits for it. Meanwhile this thread runs
/// Python's signal handlers and calls `progress`, unless it is None, with each Progress; where that
/// returns False the job is stopped. What either raises stops the job, too, and is rethrown when
/// it has ended, in place of what the job threw. Needs the GIL.
void watched(const py::object& progress, const std::function<void(Job&)>& work);

}  // namespace wheeltap::python
