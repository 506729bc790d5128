// What a run found, whatever it was about: models, their parameters, evidences, and how far the
// draws can be trusted. Terminal, summary and report are writers of it.
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

/// A parameter of a model, told by its place and not by its label.
struct Unknown {
  std::string name;   ///< "location", "k"
  std::string label;  ///< "location[1]"; with its kind's name before it where two kinds share it
  int kind = -1;      ///< of the component it belongs to; -1: the model's own
  int component = 0;  ///< which of that kind, 0-based
  int parameter = 0;  ///< which of the component's parameters, or of the space's
  std::string unit = {};  ///< "N/m", "1" of a plain number; empty where not known

  /// "k [N/m]": its label, and the unit where it has one.
  [[nodiscard]] std::string with_unit() const {
    return unit.empty() || unit == "1" ? label : label + " [" + unit + "]";
  }
};

/// The parameters of a model in the order of its parameter vector.
[[nodiscard]] std::vector<Unknown> unknowns(const inference::ModelSpace& space, int model);

struct ParameterFinding {
  Unknown unknown;
  Marginal estimate;
  std::optional<BetweenWindows> between_windows = {};  ///< where windows were asked for
  /// The probability that posterior and prior share, Σ min over twenty parts of the prior: 1 where
  /// the data said nothing. NaN where not computed.
  double prior_overlap = std::numeric_limits<double>::quiet_NaN();

  /// A posterior that repeats what the case assumed.
  [[nodiscard]] bool is_nearly_prior() const { return prior_overlap > 0.85; }
};

struct ModelFinding {
  std::string name = {};
  double prior = 0.0;            ///< probability
  std::vector<int> counts = {};  ///< of each kind of component; empty where models are a list
  int dimension = 0;
  inference::ModelStanding standing = {};
  std::vector<ParameterFinding> parameters = {};  ///< empty where no draw was in it

  [[nodiscard]] double probability() const { return standing.probability; }
  [[nodiscard]] bool drawn() const { return standing.visited > 0; }
  /// Of a kind of component; nullptr where there is none.
  [[nodiscard]] const Marginal* find(int kind, int component, int parameter) const;
  /// Of one of the model's own parameters, by name.
  [[nodiscard]] const Marginal* find(const std::string& name) const;
};

/// "tmcmc", "bridge", "laplace".
[[nodiscard]] std::string method_name(EvidenceMethod method);

/// Evidences by one method, one a model; NaN, with the reason as a warning, where it failed on a
/// model: a finished run is worth more than a comparison.
struct MethodEvidence {
  EvidenceMethod method;
  std::vector<inference::Evidence> evidences;
};

/// The evidence of every model of the problem by every method; once `stopped` says so, by those
/// alone that are done.
[[nodiscard]] std::vector<MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<EvidenceMethod>& methods,
    std::uint64_t seed, int threads, const std::function<bool()>& stopped = {});

/// What they imply beside what was sampled.
struct EvidenceFinding {
  EvidenceMethod method;
  std::vector<inference::Evidence> evidences;  ///< one a model
  inference::ImpliedProbabilities implied;
};

/// How the draws were made, and what they establish. `full_evaluations` counts those of an emulator
/// as well; without a stand-in it is `likelihood_evaluations`.
struct Sampling : inference::RunRecord {
  inference::Verdict verdict;
  inference::ModelProbabilities stationary;
  long count_round_trips = 0;  ///< between the lowest and the highest count
  bool balanced = false;
  int chains = 0;
};

struct Findings {
  std::shared_ptr<const inference::ModelSpace> space;
  std::vector<ModelFinding> models;
  std::vector<EvidenceFinding> evidence;
  Sampling sampling;
  FitVerdict fit_verdict;
  std::vector<Remark> remarks;  ///< beside what the verdict does not establish

  /// Models in the order of their probability.
  [[nodiscard]] std::vector<std::size_t> by_probability() const;
};

/// The same of a list of them.
[[nodiscard]] std::vector<std::size_t> by_probability(const std::vector<ModelFinding>& models);
/// More models than these are not all told of in full: those of at least kWorthFull are.
inline constexpr std::size_t kFewModelsTold = 40;
inline constexpr double kWorthFull = 0.005;
[[nodiscard]] bool told_in_full(const Findings& findings, const ModelFinding& model);

/// The part of the findings that does not know what the models mean. All chains must be of one
/// length, at least 4 draws.
[[nodiscard]] Findings run_findings(const inference::Posterior& posterior,
                                    const inference::Verdict& verdict, std::uint64_t seed);

/// Adds what any run may have to say last: what the methods found, with remarks where it
/// contradicts the draws or a method failed, that posteriors are nearly their priors, and that
/// likelihoods were impossible.
void conclude(Findings& findings, const inference::ModelSpace& space,
              const std::vector<MethodEvidence>& evidence);

}  // namespace wheeltap::identification
