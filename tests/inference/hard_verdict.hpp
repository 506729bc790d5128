// Whether a verdict is correct for a problem with known answer.
#pragma once

#include <cmath>

#include "inference/diagnosis/verdict.hpp"
#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {

inline constexpr double kReportedErrors = 4.0;

struct Assessment {
  int model = 0;  ///< the model with the largest error
  /// Its probability error in reported standard errors; infinite if none is reported.
  double reported_errors = 0;
  bool exact = false;  ///< every probability within 4 reported errors
  bool below_resolution = false;
  bool right = false;  ///< the requirement of the problem is met
};

inline Assessment assess(const HardProblem& problem, const Verdict& verdict) {
  Assessment out;
  for (std::size_t m = 0; m < problem.probability.size(); ++m) {
    const double off = std::fabs(verdict.models[m].probability - problem.probability[m]);
    const double mcse = verdict.models[m].mcse;
    // A negligible model has an error of 0 and needs no standard error.
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
