#include "identification/findings/findings.hpp"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "inference/evidence/bridge_sampling.hpp"
#include "inference/evidence/laplace.hpp"
#include "inference/evidence/tmcmc.hpp"

namespace wheeltap::identification {
namespace {

using inference::ChainsOf;
using inference::Posterior;

std::vector<std::vector<int>> total_counts(const Posterior& posterior) {
  std::vector<std::vector<int>> out;
  for (const auto& chain : posterior.chains) {
    out.emplace_back();
    for (const int m : chain.model) {
      const auto& counts = (*posterior.space)[m].counts;
      out.back().push_back(counts.empty() ? m : std::accumulate(counts.begin(), counts.end(), 0));
    }
  }
  return out;
}

constexpr double kWorthDescribing = 0.05;  // less probable models are not described

/// The overlap of posterior and prior. Components are sorted by their first parameter: of n
/// components, the i-th has a prior cumulative probability with distribution Beta(i, n + 1 - i).
double prior_overlap(const inference::Prior& prior, const ChainsOf& draws, int i, int n) {
  constexpr int kParts = 20;
  std::vector<double> tally(kParts);
  double all = 0.0;
  for (const auto& chain : draws) {
    for (const double x : chain) {
      const double u = 0.5 * std::erfc(-prior.to_standard_normal(x) / M_SQRT2);
      ++tally[static_cast<std::size_t>(std::clamp(static_cast<int>(u * kParts), 0, kParts - 1))];
      ++all;
    }
  }
  double overlap = 0.0, below = 0.0;
  for (int part = 0; part < kParts; ++part) {
    const double up_to = boost::math::ibeta(i, n + 1 - i, (part + 1.0) / kParts);
    overlap += std::min(tally[static_cast<std::size_t>(part)] / all, up_to - below);
    below = up_to;
  }
  return overlap;
}

/// Lists the parameters of models above kWorthDescribing about which the data have little
/// information.
void judge_priors(Findings& findings) {
  remark::NearlyPrior nearly;
  for (const ModelFinding& model : findings.models) {
    if (model.probability() < kWorthDescribing) continue;
    for (const ParameterFinding& p : model.parameters) {
      if (p.is_nearly_prior()) {
        nearly.parameters.push_back({model.name, p.unknown.label, p.prior_overlap});
      }
    }
  }
  if (!nearly.parameters.empty()) findings.remarks.push_back(std::move(nearly));
}

/// Lists the parameters of models above kWorthDescribing whose standard deviation has a large Monte
/// Carlo error.
void judge_spreads(Findings& findings) {
  remark::UncertainSpread uncertain;
  for (const ModelFinding& model : findings.models) {
    if (model.probability() < kWorthDescribing) continue;
    for (const ParameterFinding& p : model.parameters) {
      if (const Marginal& e = p.estimate; e.mcse_sd > kUncertainSpread * e.sd)
        uncertain.parameters.push_back({model.name, p.unknown.label, e.mcse_sd / e.sd});
    }
  }
  if (!uncertain.parameters.empty()) findings.remarks.push_back(std::move(uncertain));
}

}  // namespace

std::vector<std::size_t> by_probability(const std::vector<ModelFinding>& models) {
  std::vector<std::size_t> order(models.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return models[a].probability() > models[b].probability();
  });
  return order;
}

std::vector<std::size_t> Findings::by_probability() const {
  return identification::by_probability(models);
}

std::vector<Unknown> unknowns(const inference::ModelSpace& space, int model) {
  const inference::Model& m = space[model];
  std::vector<Unknown> out;
  for (int i = 0; i < m.dimension; ++i) {
    Unknown u;
    u.label = space.parameter_name(model, i);
    if (i < static_cast<int>(m.parameters.size())) {
      u.parameter = m.parameters[static_cast<std::size_t>(i)];
      u.name = space.parameters()[static_cast<std::size_t>(u.parameter)].name;
      out.push_back(std::move(u));
      continue;
    }
    std::size_t kind = space.kinds().size() - 1;
    while (i < m.offsets[kind]) --kind;
    const auto& of_kind = space.kinds()[kind].parameters;
    const int within = i - m.offsets[kind];
    u.kind = static_cast<int>(kind);
    u.component = within / static_cast<int>(of_kind.size());
    u.parameter = within % static_cast<int>(of_kind.size());
    u.name = of_kind[static_cast<std::size_t>(u.parameter)].name;
    const auto has_it = [&](const inference::ComponentKind& k) {
      return std::ranges::count(k.parameters, u.name, &inference::Parameter::name) > 0;
    };
    if (std::ranges::count_if(space.kinds(), has_it) > 1) {
      u.label = space.kinds()[kind].name + " " + u.label;
    }
    out.push_back(std::move(u));
  }
  return out;
}

const Marginal* ModelFinding::find(int kind, int component, int parameter) const {
  for (const ParameterFinding& p : parameters) {
    if (p.unknown.kind == kind && p.unknown.component == component &&
        p.unknown.parameter == parameter) {
      return &p.estimate;
    }
  }
  return nullptr;
}

const Marginal* ModelFinding::find(const std::string& of) const {
  for (const ParameterFinding& p : parameters) {
    if (p.unknown.kind < 0 && p.unknown.name == of) return &p.estimate;
  }
  return nullptr;
}

std::string method_name(EvidenceMethod method) {
  switch (method) {
    case EvidenceMethod::tmcmc:
      return "tmcmc";
    case EvidenceMethod::bridge:
      return "bridge";
    case EvidenceMethod::laplace:
      break;
  }
  return "laplace";
}

std::vector<MethodEvidence> compute_evidence(const inference::Problem& problem,
                                             const std::vector<EvidenceMethod>& methods,
                                             std::uint64_t seed, int threads,
                                             const std::function<bool()>& stopped) {
  const auto go_on = [&] { return !stopped || !stopped(); };
  std::vector<MethodEvidence> out;
  std::vector<std::optional<inference::Tmcmc>> tempered(
      static_cast<std::size_t>(problem.space.size()));
  const auto one = [&](EvidenceMethod method, int m) -> inference::Evidence {
    auto& pilot = tempered[static_cast<std::size_t>(m)];
    if (method == EvidenceMethod::tmcmc) {
      pilot = inference::tmcmc(
          problem, m,
          {.seed = seed, .threads = threads, .progress = [&](double) { return go_on(); }});
      return pilot->evidence;
    }
    if (method == EvidenceMethod::bridge) {
      const inference::BridgeOptions options{.seed = seed, .threads = threads};
      return pilot ? inference::bridge_sampling(problem, m, *pilot, options)
                   : inference::bridge_sampling(problem, m, options);
    }
    return inference::laplace(problem, m, {.seed = seed}).evidence;
  };
  for (const EvidenceMethod method : methods) {
    MethodEvidence by{.method = method, .evidences = {}};
    for (int m = 0; m < problem.space.size() && go_on(); ++m) {
      try {
        by.evidences.push_back(one(method, m));
      } catch (const inference::LikelihoodError& error) {
        by.evidences.push_back({.log_evidence = std::nan(""),
                                .standard_error = std::nan(""),
                                .likelihood_evaluations = 0,
                                .warnings = {{.kind = inference::EvidenceWarning::Kind::failed,
                                              .error = error.what()}}});
      }
    }
    if (go_on()) out.push_back(std::move(by));
  }
  return out;
}

bool told_in_full(const Findings& findings, const ModelFinding& model) {
  return findings.models.size() <= kFewModelsTold || model.probability() >= kWorthFull;
}

Findings run_findings(const Posterior& posterior, const inference::Verdict& verdict,
                      std::uint64_t seed) {
  const auto& space = *posterior.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  Findings out;
  out.space = posterior.space;
  for (int m = 0; m < space.size(); ++m) {
    ModelFinding model{.name = space[m].name,
                       .prior = std::exp(space[m].log_prior),
                       .counts = space[m].counts,
                       .dimension = space[m].dimension,
                       .standing = verdict.models[static_cast<std::size_t>(m)],
                       .parameters = {}};
    const bool drawn = std::ranges::any_of(posterior.chains, [&](const inference::Chain& chain) {
      return std::ranges::find(chain.model, m) != chain.model.end();
    });
    if (drawn) {
      const std::vector<Unknown> list = unknowns(space, m);
      for (std::size_t p = 0; p < list.size(); ++p) {
        const ChainsOf values = draws_in_model(posterior, m, [&](std::size_t c, std::size_t i) {
          return posterior.chains[c].theta[i * width + p];
        });
        const Unknown& u = list[p];
        const bool ordered = u.kind >= 0 && u.parameter == 0;
        const int among = ordered ? model.counts[static_cast<std::size_t>(u.kind)] : 1;
        model.parameters.push_back(
            {.unknown = u,
             .estimate = marginal(values),
             .prior_overlap = prior_overlap(space.prior(m, static_cast<int>(p)), values,
                                            ordered ? u.component + 1 : 1, among)});
      }
    }
    out.models.push_back(std::move(model));
  }

  std::vector<std::vector<int>> model_chains;
  for (const auto& chain : posterior.chains)
    model_chains.emplace_back(chain.model.begin(), chain.model.end());
  const auto counts = total_counts(posterior);
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const auto& chain : counts) {
    for (const int n : chain) lowest = std::min(lowest, n), highest = std::max(highest, n);
  }
  // The run time per draw grows with the cube of the number of visited models.
  const int posterior_draws = out.models.size() <= kFewModelsTold ? 1000 : 100;
  Sampling& sampling = out.sampling;
  static_cast<inference::RunRecord&>(sampling) = posterior;
  if (sampling.full_evaluations == 0) sampling.full_evaluations = sampling.likelihood_evaluations;
  sampling.verdict = verdict;
  sampling.stationary =
      inference::stationary_model_probabilities(model_chains, space.size(), seed, posterior_draws);
  sampling.count_round_trips = inference::round_trips(counts, lowest, highest);
  sampling.balanced = !posterior.log_weight.empty();
  sampling.chains = static_cast<int>(posterior.chains.size());
  return out;
}

void conclude(Findings& findings, const inference::ModelSpace& space,
              const std::vector<MethodEvidence>& evidence) {
  std::vector<double> sampled, errors;
  for (const ModelFinding& m : findings.models) {
    sampled.push_back(m.standing.probability);
    errors.push_back(m.standing.mcse);
  }
  for (const MethodEvidence& by : evidence) {
    EvidenceFinding found{.method = by.method,
                          .evidences = by.evidences,
                          .implied = inference::implied_probabilities(space, by.evidences)};
    for (std::size_t m = 0; m < by.evidences.size(); ++m) {
      const inference::Evidence& e = by.evidences[m];
      if (std::isnan(e.log_evidence) && !e.warnings.empty()) {
        findings.remarks.push_back(remark::EvidenceFailed{
            .method = by.method, .model = findings.models[m].name, .why = e.warnings[0]});
      }
    }
    for (const auto& d : inference::disagreements(sampled, errors, found.implied)) {
      findings.remarks.push_back(remark::EvidenceDisagrees{.method = by.method,
                                                           .model = space[d.model].name,
                                                           .sampled = d.sampled,
                                                           .sampled_error = d.sampled_error,
                                                           .implied = d.implied,
                                                           .implied_error = d.implied_error});
    }
    findings.evidence.push_back(std::move(found));
  }
  judge_priors(findings);
  judge_spreads(findings);
  if (findings.sampling.impossible > 0) {
    findings.remarks.push_back(remark::ImpossibleLikelihoods{
        findings.sampling.impossible, findings.sampling.likelihood_evaluations});
  }
}

}  // namespace wheeltap::identification
