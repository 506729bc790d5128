#include "apps/evidence.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "apps/failure.hpp"
#include "inference/evidence/bridge_sampling.hpp"
#include "inference/evidence/laplace.hpp"
#include "inference/evidence/tmcmc.hpp"

namespace wheeltap::apps {

std::vector<std::string> evidence_methods(const std::string& text) {
  std::vector<std::string> methods;
  std::istringstream stream(text);
  for (std::string method; std::getline(stream, method, '+');) {
    if (method != "tmcmc" && method != "bridge" && method != "laplace") {
      throw Failure(Exit::usage, "--evidence=" + text + ": methods are tmcmc, bridge and laplace");
    }
    methods.push_back(method);
  }
  return methods;
}

std::vector<MethodEvidence> compute_evidence(const inference::Problem& problem,
                                             const std::string& methods, std::uint64_t seed,
                                             int threads, spdlog::logger& log) {
  std::vector<MethodEvidence> out;
  std::vector<std::optional<inference::Tmcmc>> tempered(
      static_cast<std::size_t>(problem.space.size()));
  for (const std::string& method : evidence_methods(methods)) {
    log.info("Evidence of each model by {} ...", method);
    MethodEvidence by{.method = method, .evidences = {}};
    for (int m = 0; m < problem.space.size(); ++m) {
      auto& pilot = tempered[static_cast<std::size_t>(m)];
      inference::Evidence& evidence = by.evidences.emplace_back();
      try {
        if (method == "tmcmc") {
          pilot = inference::tmcmc(problem, m, {.seed = seed, .threads = threads});
          evidence = pilot->evidence;
        } else if (method == "bridge") {
          const inference::BridgeOptions options{.seed = seed, .threads = threads};
          evidence = pilot ? inference::bridge_sampling(problem, m, *pilot, options)
                           : inference::bridge_sampling(problem, m, options);
        } else {
          evidence = inference::laplace(problem, m, {.seed = seed}).evidence;
        }
      } catch (const inference::LikelihoodError& error) {
        // The run is finished; what fails beside it must not take it along.
        evidence.log_evidence = evidence.standard_error = std::numeric_limits<double>::quiet_NaN();
        evidence.warnings = {error.what()};
      }
    }
    out.push_back(std::move(by));
  }
  return out;
}

Report evidence_report(const inference::ModelSpace& space, const Report& models,
                       const std::vector<MethodEvidence>& list,
                       std::vector<std::string>& warnings) {
  Report out = Report::object();
  std::vector<double> sampled, errors;
  for (const Report& row : models) {
    sampled.push_back(row["probability"]);
    errors.push_back(row["mcse"]);
  }
  for (const MethodEvidence& by : list) {
    const auto implied = inference::implied_probabilities(space, by.evidences);
    Report rows = Report::array();
    for (int m = 0; m < space.size(); ++m) {
      const auto i = static_cast<std::size_t>(m);
      const auto number = [](double x) { return std::isfinite(x) ? Report(x) : Report(); };
      const inference::Evidence& e = by.evidences[i];
      rows.push_back({{"model", space[m].name},
                      {"log_evidence", number(e.log_evidence)},
                      {"standard_error", number(e.standard_error)},
                      {"log_bayes_factor", number(e.log_evidence - by.evidences[0].log_evidence)},
                      {"probability", number(implied.mean[i])},
                      {"probability_error", number(implied.standard_error[i])},
                      {"likelihood_evaluations", e.likelihood_evaluations},
                      {"warnings", e.warnings}});
      if (!std::isnan(e.log_evidence)) continue;
      for (const std::string& line : e.warnings) warnings.push_back(by.method + ": " + line);
    }
    out[by.method] = rows;
    for (const std::string& line : inference::disagreements(space, sampled, errors, implied)) {
      warnings.push_back(by.method + ": " + line);
    }
  }
  return out;
}

}  // namespace wheeltap::apps
