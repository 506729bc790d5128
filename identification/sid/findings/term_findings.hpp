// Inclusion probabilities of a chain's terms, over all subsets (sid_discovery.hpp).
#pragma once

#include <string>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/sid/findings/link_laws.hpp"

namespace wheeltap::identification {

/// One term of SidCase::discovery.
struct TermFinding {
  std::string label;       ///< "cubic 0-1", as in model names
  std::string name;        ///< law and side: "contact closing"
  int a = 0, b = 0;        ///< masses that its link joins
  double prior = 0.5;      ///< prior inclusion probability
  double inclusion = 0.0;  ///< posterior inclusion probability: sum over models with the term
  double mcse = 0.0;       ///< its Monte Carlo standard error
  bool drawn = false;      ///< by any chain
  std::vector<ParameterFinding> parameters = {};  ///< its unknown coefficients, given inclusion

  /// Included (above the limit), excluded (below one minus the limit), or neither.
  [[nodiscard]] bool is_in() const { return inclusion > kDecided; }
  [[nodiscard]] bool is_out() const { return inclusion < 1.0 - kDecided; }
  static constexpr double kDecided = 0.9;
};

/// Results of a discovery; no terms if the case requests none.
struct Discovery {
  std::vector<TermFinding> terms;  ///< in the order of the case
  std::vector<LinkLaw> laws;  ///< laws of the links with optional terms, averaged over all models
};

/// Computes inclusion probabilities from the model probabilities
/// (inference/diagnosis/standing.hpp), so that models without reliable draws count by their
/// evidence. The error combines two parts: the error of the mean of the term's indicator over the
/// chains (at least one effective draw of the model), and the errors of model probabilities from
/// evidence.
[[nodiscard]] std::vector<TermFinding> term_findings(const SidCase& sid_case,
                                                     const inference::Posterior& posterior,
                                                     const Findings& findings);

}  // namespace wheeltap::identification
