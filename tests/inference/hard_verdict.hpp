// Whether a verdict is right, where the answer is known.
#pragma once

#include <cmath>

#include "inference/diagnosis/verdict.hpp"
#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {

inline constexpr double kReportedErrors = 4.0;

struct Assessment {
  int model = 0;               ///< the one that is worst
  double reported_errors = 0;  ///< by which its probability is off; infinite where none is reported
  bool exact = false;          ///< every probability within 4 reported errors
  bool below_resolution = false;
  bool right = false;  ///< what was asked
};

inline Assessment assess(const HardProblem& problem, const Verdict& verdict) {
  Assessment out;
  for (std::size_t m = 0; m < problem.probability.size(); ++m) {
    const double off = std::fabs(verdict.models[m].probability - problem.probability[m]);
    const double mcse = verdict.models[m].mcse;
    // A model too improbable to matter has an error of 0 and needs none.
    const double errors = off < 1e-9 ? 0.0 : mcse > 0.0 ? off / mcse : HUGE_VAL;
    if (errors > out.reported_errors) {
      out.reported_errors = errors;
      out.model = static_cast<int>(m);
    }
  }
  out.exact = out.reported_errors <= kReportedErrors;
  out.below_resolution = problem.basin < verdict.resolution;
  out.right = problem.asked == Asked::found
                  ? out.exact && verdict.converged
                  : out.exact || !verdict.converged || out.below_resolution;
  return out;
}

}  // namespace wheeltap::inference
