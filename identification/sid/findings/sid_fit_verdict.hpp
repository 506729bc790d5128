// Whether the most probable equation of motion explains the record.
#pragma once

#include "identification/findings/fit_verdict.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::identification {

/// Of the most probable model that was drawn, by its best draw:
///
/// - R² of a response below 1/2, and its residuals not white (a response that is mostly the
/// sensor's
///   noise is no misfit);
/// - a residual that is no noise (portmanteau or predictive p below kMisfit) and above
///   kSmallResidual of its response, or kMuchMoreThanFree times what a free cubic chain leaves
///   (free_cubic.hpp); the latter alone where an autoregression whitens it;
/// - a residual beyond the window (SidCase::beyond) more than twice that in it, absolutely and in
///   terms of the response, and above kSmallResidual, under every one of some twenty draws: what
///   the window alone leaves open is no misfit.
///
/// `findings` must have models and forward runs.
[[nodiscard]] FitVerdict judge_fit(const SidProblem& problem, const inference::Posterior& posterior,
                                   const SidPredictive& predictive, const SidFindings& findings);

}  // namespace wheeltap::identification
