// Background threads for long work, so that Python still handles Ctrl-C and progress.
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

/// Progress of a job.
struct Progress {
  std::string stage;
  double fraction = 0.0;                   ///< completed fraction of the stage
  long evaluations = 0;                    ///< likelihood evaluations so far
  std::vector<double> probabilities = {};  ///< model probabilities so far; empty before sampling
};

/// The interface of a job for the thread that runs the job.
class Job {
 public:
  /// True if the job should stop. Thread-safe.
  [[nodiscard]] bool stopped() const { return stop_; }
  void stop() { stop_ = true; }
  /// Publishes the newest progress without waiting.
  void publish(Progress progress);

 private:
  friend void watched(const py::object&, const std::function<void(Job&)>&);
  /// Waits at most `time` for the end of the job; returns true if it has ended.
  bool ended_within(std::chrono::milliseconds time);
  [[nodiscard]] std::optional<Progress> news();

  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::optional<Progress> news_;
};

/// Calls work(job) on a thread without the GIL and waits until the call ends. Meanwhile this thread
/// runs Python's signal handlers and calls `progress` (if it is not None) with each Progress. If
/// `progress` returns False, the job stops. An exception in a handler or in `progress` also stops
/// the job and is rethrown after its end, instead of the job's exception. Requires the GIL.
void watched(const py::object& progress, const std::function<void(Job&)>& work);

}  // namespace wheeltap::python
