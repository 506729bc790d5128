// How long a run will take from here.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "inference/options.hpp"

namespace wheeltap::apps {

/// The rest of the present stage as long as that has taken so far, and the calls of the stages to
/// come as fast as those of this stage, or of the whole run where that is faster: a stage may have
/// counted few calls so far.
class TimeLeft {
 public:
  /// `least_a_call`: what a call of the stages to come takes at the least [s], where that is known.
  explicit TimeLeft(double least_a_call = 0.0) : least_a_call_(least_a_call) {}

  struct Shown {
    double fraction = 0.0;       ///< of the run's time: seconds / (seconds + left); 0: not known
    std::optional<double> left;  ///< [s]
  };
  /// What there is to show of the whole run: where a stage has just begun, what was left before
  /// less the time since.
  Shown of_run(const inference::Options::Progress& progress, double seconds) {
    if (const auto now = estimate(progress, seconds)) {
      left_ = *now;
      known_at_ = seconds;
    }
    if (!left_) return {};
    const double left = std::max(0.0, *left_ - (seconds - known_at_));
    return {.fraction = seconds / std::max(seconds + left, 1e-9), .left = left};
  }

  /// [s], `seconds` after the run began; nothing while there is too little to go by.
  std::optional<double> estimate(const inference::Options::Progress& progress, double seconds) {
    constexpr double kEnough = 1.0, kShare = 0.005;  // seconds, of the stage
    if (stage_ != progress.stage) {
      stage_ = progress.stage;
      began_ = seconds;
      calls_before_ = progress.likelihood_evaluations;
      share_before_ = progress.fraction;  // of a run that was taken up
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
