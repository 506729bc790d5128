// Results common to all kinds of runs: models, parameters, evidences and the reliability of the
// draws. Wheeltap shows these results in the terminal, the summary and the report.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identification/findings/between_windows.hpp"
#include "identification/findings/fit_verdict.hpp"
#include "identification/findings/marginal.hpp"
#include "identification/findings/remarks.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "inference/evidence/comparison.hpp"

namespace wheeltap::identification {

/// A parameter of a model, identified by its kind, component and index.
struct Unknown {
  std::string name;  ///< name of the parameter: "location", "k"
  /// Label, for example "location[1]"; begins with the kind's name if two kinds share the label
  std::string label;
  /// Kind of the component with this parameter; -1: a parameter of the model itself
  int kind = -1;
  int component = 0;      ///< 0-based index of the component within its kind
  int parameter = 0;      ///< index among the parameters of the component, or of the model space
  std::string unit = {};  ///< unit: "N/m"; "1" if dimensionless; empty if unknown

  /// Label and, if known, unit: "k [N/m]".
  [[nodiscard]] std::string with_unit() const {
    return unit.empty() || unit == "1" ? label : label + " [" + unit + "]";
  }
};

/// The unknowns of a model, in the order of its parameter vector.
[[nodiscard]] std::vector<Unknown> unknowns(const inference::ModelSpace& space, int model);

struct ParameterFinding {
  Unknown unknown;
  Marginal estimate;
  /// Results per window, if windows were requested
  std::optional<BetweenWindows> between_windows = {};
  /// The overlap of posterior and prior, Σ min(posterior, prior) over 20 prior intervals of equal
  /// probability: 1 if posterior and prior are equal. NaN if not computed.
  double prior_overlap = std::numeric_limits<double>::quiet_NaN();

  /// True if the posterior nearly equals the prior.
  [[nodiscard]] bool is_nearly_prior() const { return prior_overlap > 0.85; }
};

struct ModelFinding {
  std::string name = {};
  double prior = 0.0;            ///< prior probability of the model
  std::vector<int> counts = {};  ///< number of components of each kind; empty for a list of models
  int dimension = 0;
  inference::ModelStanding standing = {};
  std::vector<ParameterFinding> parameters = {};  ///< empty for a model without draws

  [[nodiscard]] double probability() const { return standing.probability; }
  [[nodiscard]] bool drawn() const { return standing.visited > 0; }
  /// The marginal of a component's parameter; nullptr if the model does not have this parameter.
  [[nodiscard]] const Marginal* find(int kind, int component, int parameter) const;
  /// The marginal of a parameter of the model itself; nullptr if no parameter has this name.
  [[nodiscard]] const Marginal* find(const std::string& name) const;
};

/// Name of an evidence method: "tmcmc", "bridge", "laplace".
[[nodiscard]] std::string method_name(EvidenceMethod method);

/// The evidence of each model by one method. If the method failed for a model, the evidence is NaN
/// with a warning that gives the reason, because a failure must not stop a finished run.
struct MethodEvidence {
  EvidenceMethod method;
  std::vector<inference::Evidence> evidences;
};

/// Computes the evidence of every model by every requested method. If `stopped` returns true, the
/// function ends; its result contains the completed methods only.
[[nodiscard]] std::vector<MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<EvidenceMethod>& methods,
    std::uint64_t seed, int threads, const std::function<bool()>& stopped = {});

/// The evidences by one method, and the model probabilities that follow from them.
struct EvidenceFinding {
  EvidenceMethod method;
  std::vector<inference::Evidence> evidences;  ///< evidence of each model
  inference::ImpliedProbabilities implied;
};

/// Record of the sampling, and convergence diagnosis. `full_evaluations` counts evaluations of the
/// full likelihood, which may use an emulator. Without an approximate likelihood,
/// `full_evaluations` equals `likelihood_evaluations`.
struct Sampling : inference::RunRecord {
  inference::Verdict verdict;
  inference::ModelProbabilities stationary;
  /// Number of round trips of Markov chains between the lowest and highest number of components
  long count_round_trips = 0;
  bool balanced = false;
  int chains = 0;
};

struct Findings {
  std::shared_ptr<const inference::ModelSpace> space;
  std::vector<ModelFinding> models;
  std::vector<EvidenceFinding> evidence;
  Sampling sampling;
  FitVerdict fit_verdict;
  /// Remarks in addition to the violated convergence rules in `verdict`
  std::vector<Remark> remarks;

  /// Indices of the models, most probable first.
  [[nodiscard]] std::vector<std::size_t> by_probability() const;
};

[[nodiscard]] std::vector<std::size_t> by_probability(const std::vector<ModelFinding>& models);
/// If a run has at most this number of models, every model is reported in full. In runs with more
/// models, only models with a probability of at least kWorthFull are reported in full.
inline constexpr std::size_t kFewModelsTold = 40;
inline constexpr double kWorthFull = 0.005;
[[nodiscard]] bool told_in_full(const Findings& findings, const ModelFinding& model);

/// Computes the findings that all kinds of runs share. All chains must have the same length, at
/// least 4 draws.
[[nodiscard]] Findings run_findings(const inference::Posterior& posterior,
                                    const inference::Verdict& verdict, std::uint64_t seed);

/// Adds the results of the evidence methods and the final remarks to the findings. The remarks
/// report methods that failed or contradict the draws, posteriors close to their priors, and
/// impossible likelihoods.
void conclude(Findings& findings, const inference::ModelSpace& space,
              const std::vector<MethodEvidence>& evidence);

}  // namespace wheeltap::identification
