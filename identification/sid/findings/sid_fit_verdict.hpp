// Goodness of fit: does the most probable equation of motion explain the record?
#pragma once

#include "identification/findings/fit_verdict.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::identification {

/// Assesses the fit of the best draw of the most probable model that has draws. Reasons for a
/// misfit:
///
/// - R² of a response is below 1/2 and its residuals are not white (white residuals mean that the
///   response is mostly sensor noise);
/// - a residual is not noise (portmanteau or predictive p below kMisfit) and exceeds one of two
///   limits: kSmallResidual times its response, or kMuchMoreThanFree times the residual with free
///   cubic springs (free_cubic.hpp). If an autoregression whitens the residual, only the comparison
///   with free cubic springs counts;
/// - after the window (SidCase::beyond), a residual exceeds kSmallResidual times the response and
///   is more than twice the residual within the window, absolutely and relative to the response.
///   The condition is a misfit only if the residuals of all examined draws (at most 400) meet it.
///
/// `findings` must contain models and forward runs.
[[nodiscard]] FitVerdict judge_fit(const SidProblem& problem, const inference::Posterior& posterior,
                                   const SidPredictive& predictive, const SidFindings& findings);

}  // namespace wheeltap::identification
