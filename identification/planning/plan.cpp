#include "identification/planning/plan.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "identification/invalid_input.hpp"

namespace wheeltap::identification::planning {
namespace {

/// Number of segments of the severity's prior for predictions.
constexpr int kSegments = 8, kCoarseSegments = 4;
/// Largest number of places in the search for sensors.
constexpr int kCoarsePlaces = 60;
constexpr int kRandomLayouts = 5;
const std::string kEffectiveIndependence = "effective independence",
                  kKineticEnergy = "kinetic energy", kRandom = "random ";

/// Returns the case; throws if a plan does not support its counts.
const DamageCase& checked(const DamageCase& damage_case) {
  int most = 0;
  bool intact = true, damaged = false;
  for (const DefectKind& kind : damage_case.kinds) {
    most += kind.max_count;
    damaged = damaged || std::any_of(kind.weights.begin() + 1, kind.weights.end(),
                                     [](double weight) { return weight > 0.0; });
    intact = intact && kind.min_count == 0 && kind.weights.at(0) > 0.0;
  }
  if (!intact)
    throw InvalidInput(InvalidInput::Part::models,
                       "a plan needs a positive prior probability of the intact structure: count "
                       "from \"min\": 0");
  if (most < 1)
    throw InvalidInput(InvalidInput::Part::models, "a plan needs \"max\" of at least 1");
  if (!damaged)
    throw InvalidInput(InvalidInput::Part::models,
                       "a plan needs a positive prior probability of at least one defect");
  if (most > 2)
    throw InvalidInput(
        InvalidInput::Part::models,
        std::to_string(most) + " defects at once: a plan considers at most 2; lower \"max\"");
  return damage_case;
}

double probability_damaged(const std::vector<NormalModel>& models) {
  double out = 0.0;
  for (const NormalModel& m : models)
    if (std::reduce(m.counts.begin(), m.counts.end()) > 0) out += m.prior;
  return out;
}

std::vector<double> frequency_covs(const PlanCase& plan, const PlannedStructure& structure) {
  std::vector<double> out;
  for (const double f : structure.frequencies_hz())
    out.push_back(plan.noise.frequency_cov(f, static_cast<int>(out.size())));
  return out;
}

std::string modes_name(int modes) {
  return std::to_string(modes) + (modes == 1 ? " mode" : " modes");
}

/// Scores variations with fewer scenarios than the best designs.
class Variations {
 public:
  Variations(const PlanCase& plan, const PlanModel& model, const PlanOptions& options)
      : plan_(plan), model_(model), options_(options) {}

  [[nodiscard]] int scenarios() const { return variation_tests(options_.scenarios); }

  [[nodiscard]] ScoringOptions scoring() const {
    return {.scenarios = scenarios(),
            .false_alarm = plan_.false_alarm,
            .tolerance = plan_.tolerance,
            .threads = options_.threads};
  }

  /// Scores designs with the modes of the plan and a record of this length.
  [[nodiscard]] std::vector<ScoredDesign> score(std::vector<ScoredDesign> designs,
                                                double seconds) const {
    TestNoise noise = plan_.noise;
    noise.seconds = seconds;
    std::vector<TestDesign> list;
    for (const ScoredDesign& d : designs) list.push_back(d.design);
    const auto scores =
        score_designs(model_.source(), model_.predictions(), noise, list, scoring());
    for (std::size_t i = 0; i < designs.size(); ++i) {
      designs[i].scores = scores[i];
      designs[i].seconds = seconds;
      designs[i].modes = model_.structure().modes();
    }
    return designs;
  }

  /// Scores a design with another number of modes; empty if the band has too few modes.
  [[nodiscard]] std::optional<ScoredDesign> with_modes(const TestDesign& design, int modes) const {
    PlanCase changed = plan_;
    changed.structure.modes = modes;
    const PlanModel model(changed, options_);
    if (model.structure().modes() != modes) return {};
    const auto scores =
        score_designs(model.source(), model.predictions(), plan_.noise, {design}, scoring());
    return ScoredDesign{.name = modes_name(modes),
                        .design = design,
                        .seconds = plan_.noise.seconds,
                        .modes = modes,
                        .scores = scores[0]};
  }

 private:
  const PlanCase& plan_;
  const PlanModel& model_;
  const PlanOptions& options_;
};

std::string seconds_name(double seconds) {
  return base::significant(seconds, 6) + " s";
}

std::string sensors_name(std::size_t n) {
  return n < 2 ? "frequencies alone" : std::to_string(n) + " sensors";
}

/// The interaction of two defects at places a < b in the data of a design; empty if it was not
/// predicted.
std::optional<Eigen::VectorXd> interaction_of(const PlacePredictions& predictions,
                                              const PreparedDesign& design, int a, int b) {
  const auto found = std::ranges::find_if(
      predictions.pairs, [&](const auto& pair) { return pair.a == a && pair.b == b; });
  if (found == predictions.pairs.end()) return {};
  Eigen::VectorXd out(design.data.size());
  design.data.mean(found->modes, out);
  for (const int p : {a, b})
    out -= design.test.places()[index(p)].nodes.col(
        typical_node(design.test.places()[index(p)].nodes.cols()));
  return out;
}

/// Median and 90 % quantile.
std::pair<double, double> quantiles(std::vector<double> values) {
  if (values.empty()) return {0.0, 0.0};
  std::ranges::sort(values);
  return {values[values.size() / 2], values[values.size() * 9 / 10]};
}

/// Difference between the data of two defects and the sum of their effects and interaction, in
/// standard errors per datum: median and 90 % quantile over simulated pairs.
std::pair<double, double> interaction_error(const PlanModel& model, const PreparedDesign& design) {
  PlannedStructure::Solver solver(model.structure());
  std::vector<double> found;
  Eigen::VectorXd both(design.data.size()), one(design.data.size()), other(design.data.size()),
      none(design.data.size());
  TestModes modes;
  for (std::uint64_t n = 0; n < 600 && found.size() < 100; ++n) {
    const Scenario s = model.source().draw(n, solver);
    if (s.defects.size() != 2) continue;
    const int a = std::min(s.truth.defects[0].place, s.truth.defects[1].place);
    const int b = std::max(s.truth.defects[0].place, s.truth.defects[1].place);
    const auto interaction = interaction_of(model.predictions(), design, a, b);
    design.data.mean(s.modes, both);
    if (!interaction || !solver.predict({s.defects[0]}, modes, s.draw)) continue;
    design.data.mean(modes, one);
    if (!solver.predict({s.defects[1]}, modes, s.draw)) continue;
    design.data.mean(modes, other);
    if (!solver.predict({}, modes, s.draw)) continue;
    design.data.mean(modes, none);
    one -= none;
    other -= none;
    double by = 1.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const Eigen::MatrixXd& nodes = design.test.places()[index(s.truth.defects[k].place)].nodes;
      const auto typical = nodes.col(typical_node(nodes.cols()));
      by *= (k == 0 ? one : other).dot(typical) / std::max(typical.squaredNorm(), 1e-300);
    }
    found.push_back((both - none - one - other - by * *interaction).norm() /
                    std::sqrt(static_cast<double>(both.size())));
  }
  return quantiles(std::move(found));
}

/// Difference between the effect of unknown coefficients on the data and its linear approximation,
/// in standard errors per datum: median and 90 % quantile over the draws.
std::pair<double, double> unknown_error(const PlannedStructure& structure,
                                        const PreparedDesign& design) {
  if (structure.unknowns() == 0) return {0.0, 0.0};
  PlannedStructure::Solver solver(structure);
  std::vector<double> found;
  Eigen::VectorXd mean(design.data.size());
  TestModes modes;
  for (int k = 0; k < PlannedStructure::kDraws; ++k) {
    if (!solver.predict({}, modes, k)) continue;
    design.data.mean(modes, mean);
    mean -= design.data.unknown_effect(structure.unknown_draw(k));
    found.push_back(mean.norm() / std::sqrt(static_cast<double>(mean.size())));
  }
  return quantiles(std::move(found));
}

/// Standard deviation of the components of a shape for a largest component of 1 at the sensors of
/// the design: median over the modes.
double measured_sd(const PlannedStructure& structure, const TestNoise& noise,
                   const TestDesign& design) {
  const Eigen::MatrixXd shapes = structure.intact_shapes();
  std::vector<double> ratios;
  for (Eigen::Index i = 0; i < shapes.cols() && !design.sensors.empty(); ++i) {
    const Eigen::VectorXd measured = shapes.col(i)(design.sensors);
    const double largest = measured.cwiseAbs().maxCoeff(),
                 all = shapes.col(i).cwiseAbs().maxCoeff();
    if (largest > 0.0) ratios.push_back(noise.shape_sd_now(static_cast<int>(i)) * all / largest);
  }
  if (ratios.empty()) return noise.shape_sd;
  std::ranges::sort(ratios);
  return ratios[ratios.size() / 2];
}

void compare_criteria(const PlanCase& plan, const PlanModel& model, const PlanOptions& options,
                      PlanFindings& out) {
  const Eigen::MatrixXd shapes = model.structure().intact_shapes();
  const int candidates = static_cast<int>(shapes.rows());
  const auto add = [&](std::string name, std::vector<int> sensors) {
    out.others.push_back({.name = std::move(name), .design = {.sensors = std::move(sensors)}});
  };
  if (plan.choose >= 2 && plan.choose < candidates) {  // otherwise there is one layout
    add(kEffectiveIndependence, effective_independence(shapes, plan.choose));
    add(kKineticEnergy, kinetic_energy(shapes, plan.choose));
    int number = 0;
    for (auto& layout : random_layouts(candidates, plan.choose, kRandomLayouts, options.seed))
      add(kRandom + std::to_string(++number), std::move(layout));
  }
  int number = 0;
  for (const auto& layout : plan.layouts) add("layout " + std::to_string(++number), layout);
}

void vary(const PlanCase& plan, const PlanModel& model, const PlanOptions& options,
          PlanFindings& out) {
  const Variations variations(plan, model, options);
  out.variation_scenarios = variations.scenarios();
  const TestDesign best = out.designs.front().design;
  std::vector<ScoredDesign> path = {{.name = sensors_name(0), .design = {}}};
  for (const RankedDesign& step : out.search.path)
    path.push_back({.name = sensors_name(step.design.sensors.size()), .design = step.design});
  if (plan.choose >= 2) {
    // The design after exchanges replaces the greedy design with the same number of sensors.
    path.back() = {.name = sensors_name(best.sensors.size()), .design = best};
    out.by_sensors = variations.score(path, plan.noise.seconds);
  }
  std::vector<double> lengths = plan.record_lengths;
  if (lengths.empty() && !plan.noise.has_cov())
    for (const double factor : {0.25, 0.5, 2.0, 4.0})
      lengths.push_back(factor * plan.noise.seconds);
  lengths.push_back(plan.noise.seconds);
  std::ranges::sort(lengths);
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  for (const double seconds : lengths) {
    if (plan.noise.has_cov() && seconds != plan.noise.seconds) continue;
    std::vector<ScoredDesign> list = {{.name = seconds_name(seconds), .design = best}};
    if (plan.costs && plan.choose >= 2)
      for (const ScoredDesign& d : path) list.push_back(d);
    list = variations.score(std::move(list), seconds);
    out.by_length.push_back(list.front());
    for (const ScoredDesign& d : list)
      if (plan.costs && (list.size() == 1 || &d != &list.front()))
        out.options.push_back(
            {.name = sensors_name(d.design.sensors.size()) + ", " + seconds_name(seconds),
             .sensors = d.design.sensors,
             .seconds = seconds,
             .scores = d.scores});
  }
  if (plan.noise.has_cov()) out.by_length.clear();  // the noise does not depend on the length
  const int modes = model.structure().modes();
  for (const int n : {modes - 2, modes - 1, modes, modes + 1, modes + 2})
    if (n == modes)
      out.by_modes.push_back(
          variations.score({{.name = modes_name(n), .design = best}}, plan.noise.seconds)[0]);
    else if (n >= 1)
      if (auto scored = variations.with_modes(best, n)) out.by_modes.push_back(std::move(*scored));
  std::vector<ScoredDesign> masses;
  for (std::size_t m = 0; m < model.structure().masses().size(); ++m)
    masses.push_back({.name = model.structure().masses()[m].name,
                      .design = {.sensors = best.sensors, .mass = static_cast<int>(m)}});
  if (!masses.empty()) out.by_mass = variations.score(std::move(masses), plan.noise.seconds);
  for (const ScoredDesign& d : out.by_mass)
    if (plan.costs)
      out.options.push_back({.name = sensors_name(d.design.sensors.size()) + ", " + d.name + ", " +
                                     seconds_name(d.seconds),
                             .sensors = d.design.sensors,
                             .seconds = d.seconds,
                             .mass = true,
                             .scores = d.scores});
}

/// Scores the designs: random layouts, which only show what the choice of sensors is worth, with
/// the scenarios of a variation, the others with all.
void score_all(const PlanCase& plan, const PlanModel& model, const PlanOptions& options,
               std::vector<ScoredDesign>& all) {
  for (const bool random : {false, true}) {
    std::vector<TestDesign> designs;
    std::vector<ScoredDesign*> scored;
    for (ScoredDesign& d : all)
      if (d.name.starts_with(kRandom) == random) {
        designs.push_back(d.design);
        scored.push_back(&d);
      }
    ScoringOptions scoring{
        .scenarios = random ? variation_tests(options.scenarios) : options.scenarios,
        .false_alarm = plan.false_alarm,
        .tolerance = plan.tolerance,
        .threads = options.threads};
    if (options.progress && !random)
      scoring.progress = [&](double fraction) { options.progress("simulated tests", fraction); };
    if (designs.empty()) continue;
    const auto scores =
        score_designs(model.source(), model.predictions(), plan.noise, designs, scoring);
    for (std::size_t i = 0; i < scored.size(); ++i) {
      scored[i]->scores = scores[i];
      scored[i]->seconds = plan.noise.seconds;
      scored[i]->modes = model.structure().modes();
    }
  }
}

}  // namespace

PlanModel::PlanModel(const PlanCase& plan, const PlanOptions& options)
    : structure_(checked(plan.damage_case), plan.structure),
      predictions_(predict_places(structure_, kSegments, options.threads)),
      source_(structure_, options.seed) {}

PlanCheck check_plan(const PlanCase& plan) {
  const PlannedStructure structure(checked(plan.damage_case), plan.structure);
  PlanCheck out{.models = static_cast<int>(count_models(structure.kinds()).size())};
  for (const double cov : frequency_covs(plan, structure))
    out.largest_cov = std::max(out.largest_cov, cov);
  return out;
}

double estimate_seconds(const PlanCase& plan, const PlanOptions& options) {
  const auto now = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double begun = now();
  const PlanModel model(plan, options);
  const double of_model = now() - begun;
  TestDesign design;
  for (int s = 0; s < plan.choose; ++s) design.sensors.push_back(s);
  if (plan.choose < 2) design.sensors.clear();
  const double prepared_from = now();
  const PreparedDesign prepared =
      prepare(model.structure(), model.predictions(), plan.noise, design);
  const double of_design = now() - prepared_from;
  // The first tests also fill the memory of the solver.
  constexpr int kTests = 300;
  static_cast<void>(model.source().draw(kTests, kTests, 1));
  const double drawn_from = now();
  const auto drawn = model.source().draw(0, kTests, 1);
  const double tests_from = now();
  static_cast<void>(simulate_tests(model.source(), prepared, drawn, plan.tolerance));
  const double of_draw = (tests_from - drawn_from) / kTests,
               of_test = (now() - tests_from) / kTests;
  const auto candidates = static_cast<double>(model.structure().candidates().size());
  const auto places = static_cast<double>(model.structure().places().size());
  const double choose = plan.choose, shapes = plan.choose >= 2 ? 1.0 : 0.0;
  // Ten designs, two classical layouts and frequencies alone.
  const double scored = options.scenarios * (of_draw + (1.0 + 12.0 * shapes) * of_test);
  // Record lengths, modes with models of their own, numbers of sensors and random layouts.
  const double varied = variation_tests(options.scenarios) *
                        (11.0 * of_draw + (10.0 + shapes * (choose + 5.0)) * of_test);
  const double mapped = 10.0 * places * options.tests_per_place * of_test;
  const double compared =
      shapes *
      std::min(layout_count(static_cast<int>(candidates), plan.choose) + choose * candidates,
               120.0 + candidates * (13.0 + 4.0 * choose));
  // The search has fewer places; a comparison needs about 300 tests and two preparations a design.
  const double share = std::min(1.0, kCoarsePlaces / places);
  return 5.0 * of_model + scored + varied + mapped +
         compared * share * share * (2.0 * of_design + 300.0 * of_test);
}

SensorChoice search_sensors(const PlanCase& plan, const PlanOptions& options) {
  PlanCase coarse = plan;
  coarse.structure.most_places = kCoarsePlaces;
  const PlannedStructure structure(coarse.damage_case, coarse.structure);
  const PlacePredictions predictions = predict_places(structure, kCoarseSegments, options.threads);
  const ScenarioSource source(structure, options.seed + 1);
  ChoiceOptions how{.choose = plan.choose, .threads = options.threads, .tolerance = plan.tolerance};
  how.most_scenarios = std::clamp(options.scenarios / 24, 256, 2048);
  if (options.progress)
    how.progress = [&](double fraction) { options.progress("choice of sensors", fraction); };
  return choose_sensors(source, predictions, plan.noise, how);
}

PlanFindings make_plan(const PlanCase& plan, const PlanModel& model, const PlanOptions& options) {
  const PlannedStructure& structure = model.structure();
  PlanFindings out;
  out.frequencies_hz = structure.frequencies_hz();
  out.frequency_cov = frequency_covs(plan, structure);
  std::vector<double> shape_sds;
  for (int i = 0; i < structure.modes(); ++i) shape_sds.push_back(plan.noise.shape_sd_now(i));
  out.shape_sd = quantiles(std::move(shape_sds)).first;
  for (int i = 0; i < structure.modes(); ++i)
    if (!structure.has_shape(i)) out.without_shapes.push_back(i);
  out.probability_damaged = probability_damaged(model.source().models());
  out.search = search_sensors(plan, options);
  std::vector<ScoredDesign> all;
  for (const RankedDesign& ranked : out.search.best)
    all.push_back({.name = "right location", .design = ranked.design});
  const std::size_t chosen = all.size();
  compare_criteria(plan, model, options, out);
  all.insert(all.end(), out.others.begin(), out.others.end());
  all.push_back({.name = "frequencies alone", .design = {}});
  score_all(plan, model, options, all);
  out.scenarios = options.scenarios;
  const auto first_other = all.begin() + static_cast<std::ptrdiff_t>(chosen);
  out.designs.assign(all.begin(), first_other);
  out.others.assign(first_other, all.end() - 1);
  out.frequencies_alone = all.back();
  // A classical layout that the search did not improve on is recommended.
  for (const ScoredDesign& other : out.others)
    if ((other.name == kEffectiveIndependence || other.name == kKineticEnergy) &&
        std::ranges::all_of(out.designs, [&](const ScoredDesign& d) {
          return d.scores.right_place.value < other.scores.right_place.value;
        }))
      out.designs.push_back(other);
  std::ranges::stable_sort(out.designs, [](const ScoredDesign& a, const ScoredDesign& b) {
    return std::pair(a.scores.right_place.value, a.scores.information.value) >
           std::pair(b.scores.right_place.value, b.scores.information.value);
  });
  const ScoredDesign& best = out.designs.front();
  out.measured_shape_sd = measured_sd(structure, plan.noise, best.design);
  const auto report = [&](const char* stage, double fraction) {
    if (options.progress) options.progress(stage, fraction);
  };
  report("map of detection", 0.0);
  const PreparedDesign prepared = prepare(structure, model.predictions(), plan.noise, best.design);
  const PreparedDesign alone = prepare(structure, model.predictions(), plan.noise, {});
  out.places = detect_everywhere(model.source(), model.predictions(), prepared,
                                 {.tests = options.tests_per_place,
                                  .threshold = best.scores.threshold,
                                  .tolerance = plan.tolerance,
                                  .threads = options.threads,
                                  .seed = options.seed});
  const std::vector<double> costs = plan.costs ? plan.costs->of_sensors : std::vector<double>{};
  out.confusion = find_confusion(structure, prepared.test, plan.tolerance);
  out.separations = find_separations(structure, model.predictions(), plan.noise, best.design,
                                     out.confusion.pairs, costs, options.threads);
  out.confusion_alone = find_confusion(structure, alone.test, plan.tolerance);
  out.separations_alone = find_separations(structure, model.predictions(), plan.noise, {},
                                           out.confusion_alone.pairs, costs, options.threads);
  std::tie(out.interaction_median, out.interaction_high) = interaction_error(model, prepared);
  std::tie(out.unknown_median, out.unknown_high) = unknown_error(structure, prepared);
  report("variations", 0.0);
  vary(plan, model, options, out);
  if (plan.costs) out.value = find_values(out.options, *plan.costs, out.probability_damaged);
  return out;
}

}  // namespace wheeltap::identification::planning
