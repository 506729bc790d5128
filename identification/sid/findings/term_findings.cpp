#include "identification/sid/findings/term_findings.hpp"

#include <algorithm>
#include <cmath>

#include "identification/sid/sid_discovery.hpp"
#include "inference/diagnosis/model_shares.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

bool has(const SidModel& model, int term) {
  return std::ranges::binary_search(model.terms, term);
}

// Standard error of the weighted fraction of draws with the term; at least the change that one
// effective draw of the model would cause.
double error_of_draws(const SidCase& sid_case, const Posterior& posterior, int term,
                      const std::vector<double>& weights, double inclusion, double ess_model) {
  const auto indicator = all_draws(posterior, [&](std::size_t c, std::size_t i) {
    const auto m = static_cast<std::size_t>(posterior.chains[c].model[i]);
    return weights[m] * ((has(sid_case.models[m], term) ? 1.0 : 0.0) - inclusion);
  });
  const double error = inference::mcse_mean(indicator);
  const double least = std::isfinite(ess_model) ? 1.0 / (ess_model + 2.0) : 0.0;
  return std::max(std::isfinite(error) ? error : 0.0, least);
}

// Unknown coefficients of the term, from the draws of all models with this term.
std::vector<ParameterFinding> coefficients(const SidCase& sid_case, const Posterior& posterior,
                                           int term, const std::vector<double>& weights) {
  const SidTerm& asked = sid_case.discovery->terms[static_cast<std::size_t>(term)];
  const auto& space = *posterior.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<ParameterFinding> out;
  std::vector<int> seen;
  for (const dynamics::Coefficient& c : asked.law.coefficients) {
    if (c.is_constant() || std::ranges::count(seen, c.parameter) > 0) continue;
    seen.push_back(c.parameter);
    const std::string& name = sid_case.parameters[static_cast<std::size_t>(c.parameter)].name;
    std::vector<int> slot(static_cast<std::size_t>(space.size()), -1);
    int of_space = 0;
    for (int m = 0; m < space.size(); ++m) {
      if (!has(sid_case.models[static_cast<std::size_t>(m)], term)) continue;
      for (int p = 0; p < space[m].dimension; ++p) {
        if (space.parameter_name(m, p) != name) continue;
        slot[static_cast<std::size_t>(m)] = p;
        of_space = space[m].parameters[static_cast<std::size_t>(p)];
      }
    }
    inference::ChainsOf values(posterior.chains.size()), counts(values.size());
    bool any = false;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const inference::Chain& chain = posterior.chains[k];
      for (std::size_t i = 0; i < chain.model.size(); ++i) {
        const auto m = static_cast<std::size_t>(chain.model[i]);
        if (slot[m] < 0) continue;
        values[k].push_back(chain.theta[i * width + static_cast<std::size_t>(slot[m])]);
        counts[k].push_back(weights[m]);
        any = true;
      }
    }
    if (!any) continue;
    const bool alike = posterior.log_weight.empty();
    ParameterFinding& found = out.emplace_back();
    found.unknown.name = found.unknown.label = name;
    found.unknown.parameter = of_space;
    found.estimate = marginal(values, alike ? inference::ChainsOf{} : counts);
  }
  return out;
}

}  // namespace

std::vector<TermFinding> term_findings(const SidCase& sid_case, const Posterior& posterior,
                                       const Findings& findings) {
  std::vector<TermFinding> out;
  if (!sid_case.discovery) return out;
  const SidDiscovery& asked = *sid_case.discovery;
  const std::vector<double> weights = model_weights(posterior);
  for (std::size_t t = 0; t < asked.terms.size(); ++t) {
    const SidTerm& term = asked.terms[t];
    const dynamics::Link& link =
        sid_case.models.front().chain.links[static_cast<std::size_t>(term.link)];
    TermFinding found{.label = term.name,
                      .name = term_name(term.law, link, false),
                      .a = link.a,
                      .b = link.b,
                      .prior = asked.inclusion};
    double squares = 0.0;
    for (std::size_t m = 0; m < findings.models.size(); ++m) {
      if (!has(sid_case.models[m], static_cast<int>(t))) continue;
      const ModelFinding& model = findings.models[m];
      found.inclusion += model.probability();
      found.drawn = found.drawn || model.drawn();
      if (model.standing.basis == inference::Basis::evidence &&
          std::isfinite(model.standing.mcse)) {
        squares += std::pow(model.standing.mcse, 2.0);
      }
    }
    found.inclusion = std::clamp(found.inclusion, 0.0, 1.0);
    found.mcse = std::hypot(std::sqrt(squares),
                            error_of_draws(sid_case, posterior, static_cast<int>(t), weights,
                                           found.inclusion, findings.sampling.verdict.ess_model));
    if (found.drawn) {
      found.parameters = coefficients(sid_case, posterior, static_cast<int>(t), weights);
    }
    out.push_back(std::move(found));
  }
  return out;
}

}  // namespace wheeltap::identification
