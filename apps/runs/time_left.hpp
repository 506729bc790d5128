// Estimate of the remaining time of a run.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "inference/options.hpp"

namespace wheeltap::apps {

/// Extrapolates the time of the current stage from its elapsed time. For later stages, the time per
/// likelihood evaluation is the smaller of two averages: over the current stage and over the whole
/// run. The average over the current stage alone may be inaccurate, because this stage may have few
/// evaluations so far.
class TimeLeft {
 public:
  /// `least_a_call` is a lower bound [s] of the time per likelihood evaluation in later stages; 0
  /// if unknown.
  explicit TimeLeft(double least_a_call = 0.0) : least_a_call_(least_a_call) {}

  struct Shown {
    /// Elapsed fraction of the run time, seconds / (seconds + left); 0: unknown
    double fraction = 0.0;
    std::optional<double> left;  ///< remaining time [s]
  };
  /// Returns the progress of the whole run. At the beginning of a stage, the remaining time is the
  /// last estimate minus the time since this estimate.
  Shown of_run(const inference::Options::Progress& progress, double seconds) {
    if (const auto now = estimate(progress, seconds)) {
      left_ = *now;
      known_at_ = seconds;
    }
    if (!left_) return {};
    const double left = std::max(0.0, *left_ - (seconds - known_at_));
    return {.fraction = seconds / std::max(seconds + left, 1e-9), .left = left};
  }

  /// Returns the remaining time [s] at `seconds` after the start; empty without enough progress.
  std::optional<double> estimate(const inference::Options::Progress& progress, double seconds) {
    // An estimate requires at least this time [s] and this fraction of the stage.
    constexpr double kEnough = 1.0, kShare = 0.005;
    if (stage_ != progress.stage) {
      stage_ = progress.stage;
      began_ = seconds;
      calls_before_ = progress.likelihood_evaluations;
      // Fraction of the stage that an earlier run completed; above 0 only in a resumed run
      share_before_ = progress.fraction;
    }
    const double here = seconds - began_, share = progress.fraction - share_before_;
    if (here < kEnough || share < kShare) return {};
    const double rest = here * (1.0 - progress.fraction) / share;
    const auto all = static_cast<double>(progress.likelihood_evaluations);
    const double calls = all - static_cast<double>(calls_before_);
    if (!(all > 0.0)) return rest;
    const double a_call = calls > 0.0 ? std::min(here / calls, seconds / all) : seconds / all;
    return rest + progress.evaluations_to_come * std::max(a_call, least_a_call_);
  }

 private:
  double least_a_call_;
  std::optional<double> left_;
  double known_at_ = 0.0;
  std::string stage_;
  double began_ = 0.0;
  long calls_before_ = 0;
  double share_before_ = 0.0;
};

}  // namespace wheeltap::apps
