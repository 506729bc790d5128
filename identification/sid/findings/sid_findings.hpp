// What a system identification found: which model, with what parameters, and how well it explains
// the record.
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

/// Of a drawn model, beside what every run knows of it.
struct SidModelFinding {
  std::vector<double> best_draw;  ///< in the order of its parameters
  std::vector<ChannelFit> at_mean, at_best;
  std::vector<std::vector<ChannelFit>> further;  ///< at the best draw, of each further record
  int substeps = 0;  ///< of a sample, at the posterior mean (Simulator::substeps)
  std::optional<double> step_error;
  // Of a model of at least 5 %:
  std::optional<std::vector<LinkCurve>> links;
  std::vector<ChainMode> modes;  ///< of its linear part
};

/// ln (p(data | model) / p(data | against)).
struct BayesFactor {
  int model = 0, against = 0;
  std::optional<double> log;  ///< none where nothing is known of one of them
  double error = 0.0;         ///< Monte Carlo standard error; NaN where not known
  inference::Basis basis = inference::Basis::draws;
};

struct SidFindings : Findings {
  std::vector<std::optional<SidModelFinding>> of_models;  ///< none where no draw was in it
  std::vector<BayesFactor> bayes_factors;  ///< of each further model against the first
  std::vector<double> coverage;            ///< of each response by the predictive band, a share
  int predictive_draws = 0;
  Discovery discovery;                  ///< empty where the case asks for none
  std::optional<Look> look;             ///< where it was at a part of the record alone
  std::optional<StepsRefined> refined;  ///< where the run was repeated
  long windows_evaluations = 0;         ///< likelihoods of windows, each a part of the record's
};

/// The run must have at least 4 draws a chain, all chains the same.
[[nodiscard]] SidFindings sid_findings(const SidRun& run, const SidPredictive& predictive,
                                       const std::vector<MethodEvidence>& evidence = {});

}  // namespace wheeltap::identification
