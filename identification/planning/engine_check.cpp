#include "identification/planning/engine_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;

/// Fewest local searches for each model.
constexpr int kSearches = 200;

/// A location: part of a line of sites, and position on this part [m].
struct Spot {
  int stretch = 0;
  double at = 0.0;
};

/// Whether the most probable stretches, and the median places on them, agree with the truth.
bool agree(const std::vector<std::vector<Spot>>& draws, const std::vector<Spot>& truth,
           double tolerance) {
  const auto stretches = [](const std::vector<Spot>& spots) {
    std::vector<int> out;
    for (const Spot& s : spots) out.push_back(s.stretch);
    return out;
  };
  std::map<std::vector<int>, int> counts;
  for (const auto& draw : draws) ++counts[stretches(draw)];
  if (counts.empty()) return false;
  const auto best = std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; });
  if (best->first != stretches(truth)) return false;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    std::vector<double> at;
    for (const auto& draw : draws)
      if (stretches(draw) == best->first) at.push_back(draw[k].at);
    std::ranges::nth_element(at, at.begin() + static_cast<std::ptrdiff_t>(at.size() / 2));
    if (std::abs(at[at.size() / 2] - truth[k].at) > tolerance) return false;
  }
  return true;
}

bool right_places(const DamageProblem& problem, const inference::Posterior& posterior, int model,
                  const std::vector<PlacedDefect>& truth, double tolerance) {
  std::vector<std::vector<Spot>> draws;
  const auto spot_of = [&](const PlacedDefect& d) {
    const SiteLine::Spot s = problem.kinds[index(d.kind)].line.spot(d.location);
    return Spot{s.stretch, s.s};
  };
  std::vector<PlacedDefect> defects;
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      if (chain.model[i] != model) continue;
      const auto draw = chain.draw(i, *posterior.space);
      problem.components(model, draw.theta, defects);
      std::ranges::sort(defects, [](const auto& a, const auto& b) {
        return std::pair(a.kind, a.location) < std::pair(b.kind, b.location);
      });
      if (defects.size() != truth.size()) continue;
      std::vector<Spot>& spots = draws.emplace_back();
      for (const PlacedDefect& d : defects) spots.push_back(spot_of(d));
    }
  std::vector<Spot> true_spots;
  for (const PlacedDefect& d : truth) true_spots.push_back(spot_of(d));
  return agree(draws, true_spots, tolerance);
}

/// ln π at the true damage, minus that at the highest mode that the search found in the true model.
double gain_of_truth(const PlannedStructure& structure, const DamageProblem& problem,
                     const inference::Posterior& posterior, const Scenario& scenario) {
  const int model = scenario.truth.model;
  const std::vector<DefectKind>& kinds = structure.kinds();
  std::vector<double> z;
  if (scenario.draw >= 0)
    for (const double coordinate : structure.unknown_draw(scenario.draw)) z.push_back(coordinate);
  for (const PlacedDefect& d : scenario.defects) {
    const DefectKind& kind = kinds[index(d.kind)];
    z.push_back(kind.location.to_standard_normal(d.location));
    if (const inference::Prior* severity = kind.severity_prior())
      z.push_back(severity->to_standard_normal(d.severity));
  }
  if (z.empty()) return 0.0;
  inference::ModelPosterior log_posterior(problem.problem, model);
  double highest = -kInfinity;
  for (const inference::FoundMode& mode : posterior.found[index(model)].modes)
    highest = std::max(highest, mode.log_posterior);
  return log_posterior(z).log_posterior() - highest;
}

TestEstimate difference_of(const std::vector<int>& differences) {
  const auto n = static_cast<double>(differences.size());
  if (n == 0.0) return {kNaN, kNaN};
  double sum = 0.0, squares = 0.0;
  for (const int d : differences) {
    sum += d;
    squares += d * d;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, (squares + 1.0) / n - mean * mean) / n)};
}

/// Mean difference over the models with damage, weighted by their prior probabilities.
TestEstimate weighted_difference(const std::vector<NormalModel>& models,
                                 const std::vector<std::vector<int>>& differences) {
  double weights = 0.0, mean = 0.0, variance = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (differences[m].empty()) continue;
    const TestEstimate one = difference_of(differences[m]);
    weights += models[m].prior;
    mean += models[m].prior * one.value;
    variance += std::pow(models[m].prior * one.mcse, 2);
  }
  if (weights == 0.0) return {kNaN, kNaN};
  return {mean / weights, std::sqrt(variance) / weights};
}

}  // namespace

namespace {

/// The measured modes as the only state of a structure with unknown coefficients.
MeasuredModes with_unknowns(const PlannedStructure& structure, ModalData modal) {
  ObservedStates states{.model = structure.options().unknown,
                        .unknown = std::vector<int>(index(structure.unknowns())),
                        .uniform = structure.options().uniform};
  std::iota(states.unknown.begin(), states.unknown.end(), 0);
  states.list.push_back({.name = "damaged", .data = std::move(modal), .damaged = true});
  ModalData joined = states.joined();
  return MeasuredModes(std::make_shared<const ObservedStates>(std::move(states)),
                       std::move(joined));
}

}  // namespace

DamageCase simulated_case(const PlanCase& plan, const ScenarioSource& source,
                          const TestDesign& design, const Scenario& scenario) {
  const PlannedStructure& structure = source.structure();
  const TestNumbers& numbers = scenario.numbers;
  const TestData data(structure, plan.noise, design);
  DamageCase out = plan.damage_case;
  const Index n = structure.modes();
  const Eigen::VectorXd& logs =
      data.with_shapes() ? scenario.modes.log_frequencies : scenario.modes.in_order;
  std::vector<double> hz(index(n)), sd(index(n));
  for (Index i = 0; i < n; ++i) {
    const double f = std::exp(logs[i]);
    const double cov =
        plan.noise.frequency_cov(std::exp(structure.intact().in_order[i]), static_cast<int>(i));
    hz[index(i)] = f * (1.0 + cov * numbers.frequencies[i]);
    sd[index(i)] = cov * f;
  }
  // Modes keep their numbers, so that the likelihood computes all modes up to the last measured
  // one.
  const auto rows = static_cast<Index>(structure.chosen().back() + 1);
  out.data = {};
  out.data.frequencies_hz.assign(index(rows), kNaN);
  out.data.sd_hz.assign(index(rows), kNaN);
  ModalData modal;
  modal.covariance = Eigen::MatrixXd::Identity(rows, rows);
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<Index>(structure.chosen()[index(i)]);
    out.data.frequencies_hz[index(row)] = hz[index(i)];
    out.data.sd_hz[index(row)] = sd[index(i)];
    modal.covariance(row, row) = sd[index(i)] * sd[index(i)];
  }
  modal.frequencies_hz = out.data.frequencies_hz;
  if (!data.with_shapes()) {
    // The i-th frequency is that of the i-th elastic mode.
    if (structure.unknowns() > 0) out.measured = with_unknowns(structure, std::move(modal));
    return out;
  }
  const auto m = static_cast<Index>(design.sensors.size());
  modal.shapes = Eigen::MatrixXd::Constant(rows, m, kNaN);
  modal.shape_covariances.assign(index(rows), Eigen::MatrixXd::Identity(m, m));
  for (const int s : design.sensors) modal.sensors.push_back(structure.candidates()[index(s)]);
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<Index>(structure.chosen()[index(i)]);
    const Eigen::VectorXd shape = data.measured_shape(scenario.modes, numbers, static_cast<int>(i));
    // The likelihood expects the covariance for a largest measured entry of 1.
    const double largest = std::max(shape.cwiseAbs().maxCoeff(), 1e-300);
    const double shape_sd = plan.noise.shape_sd_now(static_cast<int>(i)) / largest;
    if (data.has_shape(static_cast<int>(i))) modal.shapes.row(row) = shape.transpose() / largest;
    modal.shape_covariances[index(row)] *= shape_sd * shape_sd;
  }
  out.measured = structure.unknowns() > 0 ? with_unknowns(structure, std::move(modal))
                                          : MeasuredModes(std::move(modal));
  return out;
}

EngineOutcome identify(const PlanCase& plan, const ScenarioSource& source, const TestDesign& design,
                       std::uint64_t number, const inference::Options& options) {
  PlannedStructure::Solver solver(source.structure());
  const Scenario scenario = source.draw(number, solver);
  const auto problem = make_damage_problem(simulated_case(plan, source, design, scenario), {});
  const inference::Posterior posterior = inference::reversible_jump(problem->problem, options);
  EngineOutcome out;
  out.truth_gain = gain_of_truth(source.structure(), *problem, posterior, scenario);
  double most = -1.0;
  for (int m = 0; m < static_cast<int>(source.models().size()); ++m) {
    const double p = posterior.probability(m).value;
    const auto& counts = source.models()[index(m)].counts;
    if (std::ranges::any_of(counts, [](int c) { return c > 0; })) out.probability_damaged += p;
    if (p <= most) continue;
    most = p;
    out.model = m;
  }
  out.right = out.model == scenario.truth.model &&
              right_places(*problem, posterior, out.model, scenario.defects, plan.tolerance);
  return out;
}

EngineCheck check_by_engine(const PlanCase& plan, const PlanModel& model,
                            const ScoredDesign& design, int count,
                            const inference::Options& options,
                            const std::function<void(double)>& progress) {
  const ScenarioSource& source = model.source();
  const PreparedDesign prepared =
      prepare(source.structure(), model.predictions(), plan.noise, design.design);
  PlannedStructure::Solver solver(source.structure());
  // Tests of the healthy structure are included.
  EngineCheck out;
  std::vector<std::vector<int>> detection(source.models().size()), right(source.models().size());
  double squares = 0.0, weights = 0.0;
  for (int i = 0; i < count; ++i) {
    if (progress) progress(static_cast<double>(i) / count);
    const std::uint64_t number = kFirstCheck + static_cast<std::uint64_t>(i);
    const std::vector<Scenario> scenario = {source.draw(number, solver)};
    inference::Options own = options;
    own.seed = options.seed + number;
    if (own.quick) own.searches = std::max(own.searches, kSearches);
    CheckedTest test{.number = number,
                     .approximate = simulate_tests(source, prepared, scenario, plan.tolerance)[0],
                     .engine = identify(plan, source, design.design, number, own)};
    if (test.engine.truth_gain > kMissed) {
      ++out.missed;
      out.tests.push_back(test);
      continue;
    }
    const double p = 1.0 / (1.0 + std::exp(-test.approximate.log_odds));
    // All models have the same number of tests: weight them by their priors.
    const auto truth = index(scenario[0].truth.model);
    const double weight = source.models()[truth].prior;
    const double difference = p - test.engine.probability_damaged;
    squares += weight * difference * difference;
    weights += weight;
    if (!scenario[0].truth.defects.empty()) {
      const double threshold = 1.0 / (1.0 + std::exp(-design.scores.threshold));
      const bool by_engine = test.engine.probability_damaged > threshold;
      const bool by_plan = test.approximate.log_odds > design.scores.threshold;
      detection[truth].push_back(static_cast<int>(by_engine) - static_cast<int>(by_plan));
      right[truth].push_back(static_cast<int>(by_engine && test.engine.right) -
                             static_cast<int>(by_plan && test.approximate.right));
      ++out.damaged;
    }
    out.tests.push_back(test);
  }
  out.detection = weighted_difference(source.models(), detection);
  out.right_place = weighted_difference(source.models(), right);
  out.rms_probability = weights > 0.0 ? std::sqrt(squares / weights) : kNaN;
  return out;
}

}  // namespace wheeltap::identification::planning
