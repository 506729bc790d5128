// --evidence: each model's evidence on its own, beside what the jumps between models found.
#pragma once

#include <spdlog/logger.h>

#include <string>
#include <vector>

#include "apps/summary.hpp"
#include "inference/evidence/comparison.hpp"

namespace wheeltap::apps {

/// Evidences by one method, one a model.
struct MethodEvidence {
  std::string method;
  std::vector<inference::Evidence> evidences;
};

/// "tmcmc+bridge" → {"tmcmc", "bridge"}; none for "". Throws Failure (usage) for a method that is
/// neither tmcmc, bridge nor laplace.
[[nodiscard]] std::vector<std::string> evidence_methods(const std::string& text);

/// The evidence of every model of the problem by every method; NaN, and a warning, where a method
/// fails.
[[nodiscard]] std::vector<MethodEvidence> compute_evidence(const inference::Problem& problem,
                                                           const std::string& methods,
                                                           std::uint64_t seed, int threads,
                                                           spdlog::logger& log);

/// {"tmcmc": [{"model", "log_evidence", "standard_error", "log_bayes_factor", "probability", …},
/// …], …}. `models` is the summary's table of models; where its probabilities and the implied ones
/// are further apart than their errors allow, a sentence is added to `warnings`.
[[nodiscard]] Report evidence_report(const inference::ModelSpace& space, const Report& models,
                                     const std::vector<MethodEvidence>& list,
                                     std::vector<std::string>& warnings);

}  // namespace wheeltap::apps
