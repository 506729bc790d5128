// Diagnoses whether the most probable equation of motion explains the record.
#pragma once

#include "identification/findings/fit_verdict.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::identification {

/// Judges the most probable drawn model by its best draw. Reasons for a misfit:
///
/// - R² of a response is below 1/2 and its residuals are not white (a response that is mostly
///   sensor noise is no misfit);
/// - a residual is not noise (portmanteau or predictive p below kMisfit) and is above
///   kSmallResidual of its response, or above kMuchMoreThanFree times that of a free cubic chain
///   (free_cubic.hpp); if an autoregression makes the residual white, only the second condition
///   counts;
/// - beyond the window (SidCase::beyond) a residual is more than twice that within the window,
///   absolutely and relative to the response, and above kSmallResidual, for every one of some
///   twenty draws. An error after the window is a misfit only if all these draws have it.
///
/// `findings` must have models and forward runs.
[[nodiscard]] FitVerdict judge_fit(const SidProblem& problem, const inference::Posterior& posterior,
                                   const SidPredictive& predictive, const SidFindings& findings);

}  // namespace wheeltap::identification
