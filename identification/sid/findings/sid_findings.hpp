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

/// Results of a drawn model, in addition to those of every run.
struct SidModelFinding {
  std::vector<double> best_draw;  ///< in the order of its parameters
  std::vector<ChannelFit> at_mean, at_best;
  std::vector<std::vector<ChannelFit>> further;  ///< at the best draw, for each further record
  int substeps = 0;  ///< per sample, at the posterior mean (Simulator::substeps)
  std::optional<double> step_error;
  // Computed only for models of at least 5 %:
  std::optional<std::vector<LinkCurve>> links;
  std::vector<ChainMode> modes;  ///< modes of the linear part
};

/// ln (p(data | model) / p(data | against)).
struct BayesFactor {
  int model = 0, against = 0;
  std::optional<double> log;  ///< empty if either evidence is unknown
  double error = 0.0;         ///< Monte Carlo standard error; NaN if unknown
  inference::Basis basis = inference::Basis::draws;
};

struct SidFindings : Findings {
  std::vector<std::optional<SidModelFinding>> of_models;  ///< empty for models without draws
  std::vector<BayesFactor> bayes_factors;                 ///< each further model against the first
  std::vector<double> coverage;  ///< share of each response's samples within the predictive band
  int predictive_draws = 0;
  Discovery discovery;                  ///< empty if not requested
  std::optional<Look> look;             ///< if the run used only part of the record
  std::optional<StepsRefined> refined;  ///< if the run was repeated
  long windows_evaluations = 0;         ///< likelihoods of windows, each of a part of the record
};

/// Computes the findings. The run must have at least 4 draws per chain and chains of equal length.
[[nodiscard]] SidFindings sid_findings(const SidRun& run, const SidPredictive& predictive,
                                       const std::vector<MethodEvidence>& evidence = {});

}  // namespace wheeltap::identification
