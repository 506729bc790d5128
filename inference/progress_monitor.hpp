// Progress reports from a run to its caller.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <vector>

#include "base/parallel.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Calls the caller's progress function from one thread at a time, and passes the caller's
/// request to stop to all threads.
class ProgressMonitor {
 public:
  ProgressMonitor(const Options& options, int models)
      : options_(options), visits_(static_cast<std::size_t>(models)) {}

  /// `to_come`: planned likelihood evaluations of the later stages.
  void begin(const char* stage, double total, double to_come = 0.0) {
    stage_ = stage;
    total_ = total;
    to_come_ = to_come;
    done_ = 0.0;
    last_ = {};  // reports the start of a stage at once
  }
  void evaluated(long n) { evaluations_ += n; }
  void visited(const std::vector<long>& visits) {
    const std::scoped_lock lock(mutex_);
    for (std::size_t m = 0; m < visits.size(); ++m) visits_[m] += visits[m];
  }
  /// Returns false if the caller wants to stop.
  bool advance(double work) {
    const std::scoped_lock lock(mutex_);
    done_ += work;
    const auto now = std::chrono::steady_clock::now();
    if (!options_.progress || now - last_ < std::chrono::milliseconds(100)) return !stopped();
    last_ = now;
    Options::Progress progress{.stage = stage_,
                               .fraction = std::min(1.0, done_ / total_),
                               .likelihood_evaluations = evaluations_,
                               .evaluations_to_come = to_come_,
                               .model_probabilities = {}};
    long sum = 0;
    for (const long n : visits_) sum += n;
    if (sum > 0) {
      for (const long n : visits_) {
        progress.model_probabilities.push_back(static_cast<double>(n) / static_cast<double>(sum));
      }
    }
    if (!options_.progress(progress)) {
      stop_ = true;
      if (base::ranks() != nullptr) base::ranks()->ask_to_stop();
    }
    return !stopped();
  }
  /// True if this thread has received a request to stop the run (base::is_to_stop).
  [[nodiscard]] bool stopped() const {
    return base::is_to_stop(stop_ || (options_.stop && options_.stop()));
  }

 private:
  const Options& options_;
  const char* stage_ = "";
  double total_ = 1.0;
  double done_ = 0.0;
  double to_come_ = 0.0;
  std::atomic<long> evaluations_{0};
  std::vector<long> visits_;
  std::chrono::steady_clock::time_point last_{};
  std::mutex mutex_;
  std::atomic<bool> stop_{false};
};

}  // namespace wheeltap::inference
