// Results of a system identification: models, parameters and fit to the record.
#pragma once

#include <optional>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/sid/findings/chain_modes.hpp"
#include "identification/sid/findings/link_laws.hpp"
#include "identification/sid/findings/term_findings.hpp"
#include "identification/sid/sid_fit.hpp"
#include "identification/sid/sid_predictive.hpp"
#include "identification/sid/sid_run.hpp"

namespace wheeltap::identification {

/// Results of a model with draws, in addition to the results common to all kinds of runs.
struct SidModelFinding {
  std::vector<double> best_draw;  ///< parameters of the draw with the highest posterior density
  std::vector<ChannelFit> at_mean, at_best;
  std::vector<std::vector<ChannelFit>> further;  ///< fits of each further record, at the best draw
  int substeps = 0;  ///< time steps per sample at the posterior mean (Simulator::substeps)
  std::optional<double> step_error;
  // Computed only for models with a probability of at least 5 %:
  std::optional<std::vector<LinkCurve>> links;
  std::vector<ChainMode> modes;  ///< modes of the linear part of the chain
};

/// Log Bayes factor ln (p(data | model) / p(data | against)) of two models.
struct BayesFactor {
  int model = 0, against = 0;
  std::optional<double> log;  ///< empty if the evidence of a model is unknown
  double error = 0.0;         ///< Monte Carlo standard error; NaN if unknown
  inference::Basis basis = inference::Basis::draws;
};

struct SidFindings : Findings {
  /// One entry per model; empty for models without draws
  std::vector<std::optional<SidModelFinding>> of_models;
  /// Bayes factor of each model after the first against the first model
  std::vector<BayesFactor> bayes_factors;
  std::vector<double> coverage;  ///< fraction of each response's samples in its predictive band
  int predictive_draws = 0;
  Discovery discovery;  ///< results of the discovery of force laws; empty if not requested
  /// Part of the record that a quick run used; empty if the run used all samples
  std::optional<Look> look;
  std::optional<StepsRefined> refined;  ///< new integration settings, if the run was repeated
  /// Number of likelihood evaluations for windows; each evaluation uses one window only
  long windows_evaluations = 0;
};

/// Computes the findings. The run must have at least 4 draws per chain and chains of equal length.
[[nodiscard]] SidFindings sid_findings(const SidRun& run, const SidPredictive& predictive,
                                       const std::vector<MethodEvidence>& evidence = {});

}  // namespace wheeltap::identification
