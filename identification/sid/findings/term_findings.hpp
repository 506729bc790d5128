// Inclusion probabilities of the terms of a chain of masses, over all subsets (sid_discovery.hpp).
#pragma once

#include <string>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/sid/findings/link_laws.hpp"

namespace wheeltap::identification {

/// One term of SidCase::discovery.
struct TermFinding {
  std::string label;       ///< "cubic 0-1", as in model names
  std::string name;        ///< force law and side: "contact closing"
  int a = 0, b = 0;        ///< masses at the ends of the link
  double prior = 0.5;      ///< prior inclusion probability
  double inclusion = 0.0;  ///< posterior inclusion probability: total of models with the term
  double mcse = 0.0;       ///< Monte Carlo standard error of `inclusion`
  bool drawn = false;      ///< true if any Markov chain has a draw with the term
  /// Unknown coefficients of the term, given that the term is included
  std::vector<ParameterFinding> parameters = {};

  /// is_in: true if the inclusion probability is above kDecided (the term counts as included).
  /// is_out: true if it is below 1 - kDecided (the term counts as excluded).
  [[nodiscard]] bool is_in() const { return inclusion > kDecided; }
  [[nodiscard]] bool is_out() const { return inclusion < 1.0 - kDecided; }
  static constexpr double kDecided = 0.9;
};

/// Results of a discovery of force laws; without terms if the case requests no discovery.
struct Discovery {
  std::vector<TermFinding> terms;  ///< terms in the order of the case
  /// Force laws of the links with optional terms, averaged over all models
  std::vector<LinkLaw> laws;
};

/// Computes inclusion probabilities from the model probabilities. If the draws of a model are not
/// reliable, the model probability comes from the evidence of the model
/// (inference/diagnosis/standing.hpp). The error of an inclusion probability combines two errors.
/// The first is the error of the mean of the term's indicator over the Markov chains (at least the
/// effect of one effective draw). The second is due to the errors of model probabilities from
/// evidence.
[[nodiscard]] std::vector<TermFinding> term_findings(const SidCase& sid_case,
                                                     const inference::Posterior& posterior,
                                                     const Findings& findings);

}  // namespace wheeltap::identification
