#include "coverage_row.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::coverage {
namespace {

using identification::DamageFindings, identification::DamageProblem, identification::DefectKind;
using inference::Posterior;
using Components = std::vector<DamageProblem::Component>;
using Function = std::function<double(const Components&)>;

/// The parameter vector of the truth, as its model lays it out.
std::vector<double> vector_of_truth(const std::vector<DefectKind>& kinds) {
  std::vector<double> x;
  for (const DefectKind& kind : kinds)
    for (const DefectKind::True& t : kind.truth) {
      x.push_back(t.location);
      x.push_back(t.severity);
    }
  return x;
}

/// Ranks the truth among draws, all of them or those of one model.
class Ranks {
 public:
  Ranks(const DamageProblem& problem, const Posterior& posterior, int true_model,
        base::Random& random)
      : problem_(problem),
        posterior_(posterior),
        true_model_(true_model),
        random_(random),
        weights_(identification::model_weights(posterior)),
        truth_(vector_of_truth(problem.damage_case.kinds)) {}

  [[nodiscard]] const std::vector<double>& truth() const { return truth_; }

  double among_all(const Function& g) {
    return among(g(problem_.components(true_model_, truth_)),
                 [&](std::size_t c, std::size_t i) { return g(components(c, i)); });
  }
  double of_log_likelihood(double true_value) {
    return among(true_value, [&](std::size_t c, std::size_t i) {
      return posterior_.chains[c].log_likelihood[i];
    });
  }
  /// Among the draws of the true model; NaN where they are too few.
  double given_model(const Function& g) {
    const auto chains = identification::draws_in_model(
        posterior_, true_model_, [&](std::size_t c, std::size_t i) { return g(components(c, i)); });
    std::vector<double> draws;
    for (const auto& chain : chains) draws.insert(draws.end(), chain.begin(), chain.end());
    const double own = g(problem_.components(true_model_, truth_));
    if (draws.empty() || !(identification::marginal(chains).ess_bulk >= kEnough))
      return std::nan("");
    double below = 0.0;
    for (const double value : draws) below += value < own ? 1.0 : 0.0;
    return below / static_cast<double>(draws.size());
  }

 private:
  Components components(std::size_t c, std::size_t i) const {
    const auto width = static_cast<std::size_t>(posterior_.dimension);
    const inference::Chain& chain = posterior_.chains[c];
    return problem_.components(chain.model[i], {chain.theta.data() + i * width, width});
  }
  double among(double own, const std::function<double(std::size_t, std::size_t)>& value) {
    double below = 0.0, same = 0.0, all = 0.0;
    for (std::size_t c = 0; c < posterior_.chains.size(); ++c)
      for (std::size_t i = 0; i < posterior_.chains[c].size(); ++i) {
        const double weight = weights_[static_cast<std::size_t>(posterior_.chains[c].model[i])];
        const double v = value(c, i);
        (v < own ? below : (v == own ? same : all)) += weight;
      }
    all += below + same;
    return (below + random_.uniform() * same) / all;
  }

  const DamageProblem& problem_;
  const Posterior& posterior_;
  int true_model_;
  base::Random& random_;
  std::vector<double> weights_;
  std::vector<double> truth_;
};

void rank(Row& row, Ranks& ranks, const std::vector<DefectKind>& kinds) {
  const auto within = [&](const std::string& name, const Function& g) {
    if (const double u = ranks.given_model(g); !std::isnan(u)) row.ranks[name].push_back(u);
  };
  const Function deepest = [&](const Components& list) {
    double most = 0.0;
    for (const auto& c : list)
      most = std::max(
          most, c.severity / kinds[static_cast<std::size_t>(c.kind)].severity_prior()->upper());
    return most;
  };
  row.ranks["number of all"].push_back(
      ranks.among_all([](const Components& list) { return static_cast<double>(list.size()); }));
  row.ranks["deepest of all"].push_back(ranks.among_all(deepest));
  if (!ranks.truth().empty()) within("deepest", deepest);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto sum = [k](auto part) -> Function {
      return [k, part](const Components& list) {
        double total = 0.0;
        for (const auto& c : list)
          if (c.kind == static_cast<int>(k)) total += part(c);
        return total;
      };
    };
    const Function severity = sum([](const auto& c) { return c.severity; });
    row.ranks["number"].push_back(ranks.among_all(sum([](const auto&) { return 1.0; })));
    row.ranks["severity of all"].push_back(ranks.among_all(severity));
    if (!kinds[k].truth.empty()) within("severity", severity);
    if (kinds[k].truth.size() == 1) within("place", sum([](const auto& c) { return c.location; }));
  }
}

std::string name_of(const identification::Remark& remark) {
  namespace r = identification::remark;
  return std::visit(
      []<class T>(const T&) -> std::string {
        if constexpr (std::is_same_v<T, r::NearlyPrior>) return "nearly prior";
        if constexpr (std::is_same_v<T, r::FrequenciesOutOfReach>) return "out of reach";
        if constexpr (std::is_same_v<T, r::NoiseHidesDamage>) return "noise hides damage";
        if constexpr (std::is_same_v<T, r::MirrorImages>) return "";  // of places alone
        if constexpr (std::is_same_v<T, r::StructureImages>) return "";
        if constexpr (std::is_same_v<T, r::RivalPlaces>) return "";
        if constexpr (std::is_same_v<T, r::FittedNotTested>) return "fitted, not tested";
        if constexpr (std::is_same_v<T, r::CannotExclude>) return "cannot exclude";
        if constexpr (std::is_same_v<T, r::NoModelFits>) return "no model fits";
        if constexpr (std::is_same_v<T, r::LargestCount>) return "";  // half of the cases' truth
        if constexpr (std::is_same_v<T, r::SeverityAtBound>) return "severity at bound";
        return "other";
      },
      remark);
}

}  // namespace

double Row::probability_of_truth() const {
  for (const Model& model : models)
    if (model.counts == truth) return model.probability;
  return 0.0;
}

Row run(const RandomCase& random_case, inference::Options options) {
  Row row{.number = random_case.number, .family = random_case.family, .cv = random_case.cv};
  const auto problem = identification::make_damage_problem(random_case.damage_case, {});
  const std::vector<DefectKind>& kinds = problem->damage_case.kinds;
  for (const DefectKind& kind : kinds) {
    row.kinds.emplace_back(kind.type->name);
    row.most.push_back(kind.max_count);
    row.truth.push_back(static_cast<int>(kind.truth.size()));
  }
  row.modes = problem->damage_case.data.modes();
  const auto seed = static_cast<std::uint64_t>(row.number) + 1;
  const auto begin = std::chrono::steady_clock::now();
  options.seed = seed;
  options.threads = 1;
  const Posterior posterior = inference::reversible_jump(problem->problem, options);
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  row.likelihood_calls = static_cast<double>(posterior.likelihood_evaluations);
  const DamageFindings found = identification::damage_findings(*problem, posterior, {}, seed);
  for (const auto& model : found.models) row.models.push_back({model.counts, model.probability()});
  row.converged = found.sampling.verdict.converged;
  for (const auto& reason : found.sampling.verdict.not_established)
    row.why_not.push_back(inference::describe(reason, problem->problem.space));
  if (!found.fit_verdict.ok()) row.warnings.emplace_back("misfit");
  for (const auto& remark : found.remarks)
    if (std::string name = name_of(remark); !name.empty()) row.warnings.push_back(std::move(name));

  base::Random random(random_case.seed, static_cast<std::uint64_t>(row.number), 1,
                      base::Purpose::test);
  const int true_model = problem->problem.space.find(row.truth);
  Ranks ranks(*problem, posterior, true_model, random);
  rank(row, ranks, kinds);
  const double true_value = problem->fe_likelihood()->log_likelihood(true_model, ranks.truth());
  row.ranks["log likelihood"].push_back(ranks.of_log_likelihood(true_value));
  double most = -INFINITY;
  for (const auto& chain : posterior.chains)
    most = std::max(most, *std::ranges::max_element(chain.log_likelihood));
  row.truth_above_draws = true_value - most;
  return row;
}

std::string Row::to_line() const {
  nlohmann::json models_json = nlohmann::json::array();
  for (const Model& model : models) {
    nlohmann::json entry = {{"counts", model.counts}, {"P", model.probability}};
    models_json.push_back(std::move(entry));
  }
  return nlohmann::json{{"case", number},
                        {"family", family},
                        {"kinds", kinds},
                        {"most", most},
                        {"truth", truth},
                        {"cv", cv},
                        {"modes", modes},
                        {"models", models_json},
                        {"converged", converged},
                        {"why_not", why_not},
                        {"warnings", warnings},
                        {"ranks", ranks},
                        {"truth_above_draws", truth_above_draws},
                        {"likelihood_calls", likelihood_calls},
                        {"seconds", seconds}}
      .dump();
}

Row Row::from_line(const std::string& line) {
  const nlohmann::json j = nlohmann::json::parse(line);
  Row row;
  j.at("case").get_to(row.number);
  j.at("family").get_to(row.family);
  j.at("kinds").get_to(row.kinds);
  j.at("most").get_to(row.most);
  j.at("truth").get_to(row.truth);
  j.at("cv").get_to(row.cv);
  j.at("modes").get_to(row.modes);
  for (const auto& model : j.at("models"))
    row.models.push_back({model.at("counts").get<std::vector<int>>(), model.at("P").get<double>()});
  j.at("converged").get_to(row.converged);
  j.at("why_not").get_to(row.why_not);
  j.at("warnings").get_to(row.warnings);
  j.at("ranks").get_to(row.ranks);
  j.at("truth_above_draws").get_to(row.truth_above_draws);
  j.at("likelihood_calls").get_to(row.likelihood_calls);
  j.at("seconds").get_to(row.seconds);
  return row;
}

}  // namespace wheeltap::coverage
