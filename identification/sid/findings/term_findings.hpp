// Which terms a chain has, by all subsets of them together (sid_discovery.hpp).
#pragma once

#include <string>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/sid/findings/link_laws.hpp"

namespace wheeltap::identification {

/// One term of SidCase::discovery.
struct TermFinding {
  std::string label;                              ///< "cubic 0-1", as in the names of models
  std::string name;                               ///< of the law, with its side: "contact closing"
  int a = 0, b = 0;                               ///< the masses its link joins
  double prior = 0.5;                             ///< probability
  double inclusion = 0.0;                         ///< probability: that of the models that have it
  double mcse = 0.0;                              ///< Monte Carlo standard error of it
  bool drawn = false;                             ///< by any chain
  std::vector<ParameterFinding> parameters = {};  ///< its unknown coefficients, given that it is in

  /// In (above the limit), out (below one less the limit), or neither.
  [[nodiscard]] bool is_in() const { return inclusion > kDecided; }
  [[nodiscard]] bool is_out() const { return inclusion < 1.0 - kDecided; }
  static constexpr double kDecided = 0.9;
};

/// What a discovery found; no terms where the case asked for none.
struct Discovery {
  std::vector<TermFinding> terms;  ///< in the order of the case
  std::vector<LinkLaw> laws;       ///< of the links that were asked about, over all models
};

/// Inclusion probabilities from the models' standings, so that models which the draws cannot speak
/// for count with their evidence. The error is that of the mean of the term's indicator over the
/// chains, at least one effective draw of the model, with the errors of models known by evidence.
[[nodiscard]] std::vector<TermFinding> term_findings(const SidCase& sid_case,
                                                     const inference::Posterior& posterior,
                                                     const Findings& findings);

}  // namespace wheeltap::identification
