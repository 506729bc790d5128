// Studies of wheeltap plan: predictions against tests that the full engine identifies, and chosen
// layouts against effective independence.
//
//   planning_study agreement beam|frame|space TESTS [quick [FIRST]]   one line of JSON a test, then
//   the
//                                                             comparison; quick runs of the engine
//   planning_study truths beam|frame|space TESTS [SEARCHES]  does the engine find two damages?
//   planning_study layouts STRUCTURES [FIRST]         one line of JSON a random plane frame
//   planning_study time [SCENARIOS [THREADS]]         search and scores of a frame with 60
//   candidates
//   planning_study score [SCENARIOS]                  processor time of one simulated test
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <numeric>
#include <span>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "fem/structures/mesh.hpp"
#include "identification/planning/engine_check.hpp"
#include "identification/structural/defects/reduction.hpp"

namespace {

using namespace wheeltap;
using namespace wheeltap::identification;
using namespace wheeltap::identification::planning;

const fem::Material kSteel{.young = 210e9, .poisson = 0.3, .density = 7850.0};

void add_member(fem::Structure& s, int a, int b, const fem::MemberSection& section, int elements) {
  const double length = fem::norm(fem::difference(s.nodes[index(b)].at, s.nodes[index(a)].at));
  s.members.push_back({.name = s.nodes[index(a)].name + "-" + s.nodes[index(b)].name,
                       .nodes = {a, b},
                       .elements = elements,
                       .pieces = {{.to = length, .material = kSteel, .section = section}}});
}

/// A plane frame with `bays` and `storeys`.
fem::Structure plane_frame(const std::vector<double>& x, const std::vector<double>& y,
                           int elements) {
  const fem::MemberSection column{
      .area = 5e-3, .second_moment_y = 1.7e-5, .shear_coefficient_z = 0.85, .depth = 0.2};
  const fem::MemberSection beam{
      .area = 4e-3, .second_moment_y = 1.2e-5, .shear_coefficient_z = 0.85, .depth = 0.18};
  fem::Structure s{.dimension = 2, .nodes = {}, .members = {}};
  const int columns = static_cast<int>(x.size()), levels = static_cast<int>(y.size());
  for (int l = 0; l < levels; ++l)
    for (int c = 0; c < columns; ++c)
      s.nodes.push_back({std::string(1, static_cast<char>('A' + c)) + std::to_string(l),
                         {x[index(c)], y[index(l)], 0.0}});
  for (int l = 0; l + 1 < levels; ++l)
    for (int c = 0; c < columns; ++c)
      add_member(s, columns * l + c, columns * (l + 1) + c, column, elements);
  for (int l = 1; l < levels; ++l)
    for (int c = 0; c + 1 < columns; ++c)
      add_member(s, columns * l + c, columns * l + c + 1, beam, elements);
  for (int c = 0; c < columns; ++c)
    s.supports.push_back({.node = c, .fix = {true, true, true, true, true, true}});
  return s;
}

/// A rectangular table of unequal sides on four columns.
fem::Structure space_frame() {
  const fem::MemberSection column{.area = 6e-3,
                                  .second_moment_y = 2.6e-5,
                                  .second_moment_z = 1.9e-5,
                                  .torsion_constant = 1e-5,
                                  .depth = 0.2};
  const fem::MemberSection beam{.area = 5e-3,
                                .second_moment_y = 3.1e-5,
                                .second_moment_z = 1.1e-5,
                                .torsion_constant = 8e-6,
                                .depth = 0.2};
  fem::Structure s{.dimension = 3, .nodes = {}, .members = {}};
  const double at[4][2] = {{0.0, 0.0}, {5.0, 0.0}, {5.6, 3.7}, {0.3, 4.0}};
  for (const double z : {0.0, 3.2})
    for (int c = 0; c < 4; ++c)
      s.nodes.push_back({std::string(1, static_cast<char>('A' + c)) + (z > 0.0 ? "1" : "0"),
                         {at[c][0], at[c][1], z}});
  for (int c = 0; c < 4; ++c) add_member(s, c, 4 + c, column, 6);
  for (int c = 0; c < 4; ++c) add_member(s, 4 + c, 4 + (c + 1) % 4, beam, 6);
  for (int c = 0; c < 4; ++c)
    s.supports.push_back({.node = c, .fix = {true, true, true, true, true, true}});
  return s;
}

void allow_reductions(DamageCase& damage_case, SiteLine line, int most) {
  DefectKind kind{.type = &defects::kReduction,
                  .name = "damage",
                  .plural = "damages",
                  .max_count = most,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.6})};
  kind.line = std::move(line);
  damage_case.kinds = {std::move(kind)};
  damage_case.data.frequencies_hz = {1.0};
  damage_case.data.sd_hz = {1.0};
  complete(damage_case);
}

/// Sensors at nodes and inside members, in all translations: in the middle of the members and, with
/// `in_columns`, at the third points of the vertical ones.
std::vector<Sensor> sensors_of(const fem::Structure& s, bool in_members, int most,
                               bool in_columns = false) {
  const fem::Mesh mesh(s);
  std::vector<Sensor> out;
  const int directions = s.dimension;
  const auto add = [&](const std::string& name, const fem::SparseRow& motion) {
    if (!motion.empty() && static_cast<int>(out.size()) < most) out.push_back({name, motion});
  };
  for (std::size_t n = 0; n < s.nodes.size(); ++n)
    for (int d = 0; d < directions; ++d)
      add(s.nodes[n].name + ", " + std::to_string(d),
          mesh.motion(static_cast<int>(n), static_cast<fem::Direction>(d)));
  for (std::size_t m = 0; in_members && m < s.members.size(); ++m) {
    const auto& ends = s.members[m].nodes;
    const bool is_column = s.nodes[index(ends[0])].at[0] == s.nodes[index(ends[1])].at[0];
    std::vector<double> shares = {0.5};
    if (in_columns && is_column) shares = {1.0 / 3.0, 2.0 / 3.0};
    for (const double share : shares)
      for (int d = 0; d < directions; ++d)
        add(s.members[m].name + ", " + std::to_string(d),
            mesh.motion(static_cast<int>(m), share * mesh.member_length(static_cast<int>(m)),
                        static_cast<fem::Direction>(d)));
  }
  return out;
}

PlanCase of_structure(const fem::Structure& s, int most_damages, int choose, int modes,
                      bool in_members, int candidates) {
  const fem::Mesh mesh(s);
  std::vector<int> members;
  for (std::size_t m = 0; m < s.members.size(); ++m) members.push_back(static_cast<int>(m));
  PlanCase plan;
  plan.damage_case.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = s});
  allow_reductions(plan.damage_case, SiteLine::of_members(mesh, members), most_damages);
  plan.structure = {.modes = modes, .candidates = sensors_of(s, in_members, candidates)};
  plan.noise = {.seconds = 600.0, .damping = 0.005, .shape_sd = 0.02, .reference_seconds = 600.0};
  plan.choose = choose;
  plan.tolerance = 0.6;
  return plan;
}

PlanCase named(const std::string& name) {
  if (name == "frame")
    return of_structure(plane_frame({0.0, 4.0, 9.0}, {0.0, 3.0, 6.5}, 6), 2, 5, 8, true, 100);
  if (name == "space") return of_structure(space_frame(), 2, 5, 8, true, 100);
  PlanCase plan;
  plan.damage_case.beam = {
      .length = 1.0,
      .elements = 40,
      .supports = fem::named_supports("simply-supported", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = {.area = 1.5e-4, .second_moment = 4.5e-10, .shear_coefficient = 0.85}};
  allow_reductions(plan.damage_case, SiteLine::of_beam(plan.damage_case.beam), 2);
  const fem::Structure s = fem::as_structure(plan.damage_case.beam);
  const fem::Mesh mesh(s);
  for (int i = 1; i < 20; ++i)
    plan.structure.candidates.push_back(
        {std::to_string(5 * i) + " %", mesh.motion(0, 0.05 * i, fem::Direction::y)});
  plan.structure.modes = 6;
  plan.noise = {.seconds = 600.0, .damping = 0.005, .shape_sd = 0.02, .reference_seconds = 600.0};
  plan.choose = 4;
  plan.tolerance = 0.05;
  return plan;
}

int agreement(const std::string& name, int tests, bool quick, int first_test) {
  const PlanCase plan = named(name);
  const PlanOptions options{.scenarios = 20'000, .threads = base::thread_count(0)};
  const PlanModel model(plan, options);
  const SensorChoice choice = choose_sensors(model.source(), model.predictions(), plan.noise,
                                             {.choose = plan.choose,
                                              .threads = options.threads,
                                              .tolerance = plan.tolerance,
                                              .most_scenarios = 512});
  ScoredDesign design{.name = name, .design = choice.best.front().design};
  design.scores = score_designs(model.source(), model.predictions(), plan.noise, {design.design},
                                {.scenarios = options.scenarios,
                                 .false_alarm = plan.false_alarm,
                                 .tolerance = plan.tolerance,
                                 .threads = options.threads})[0];
  std::fprintf(stderr, "design scored\n");
  const double threshold = 1.0 / (1.0 + std::exp(-design.scores.threshold));
  const PreparedDesign prepared =
      prepare(model.structure(), model.predictions(), plan.noise, design.design);
  PlannedStructure::Solver solver(model.structure());
  const auto intact = index(prepared.test.intact());
  int damaged = 0, detected = 0, right = 0, by_plan = 0, right_by_plan = 0, missed = 0;
  double squares = 0.0;
  const auto print = [&](int done) {
    const double n = std::max(damaged, 1);
    const auto compared = [&](const TestEstimate& predicted, int same, int engine) {
      // The standard error of a share of n tests, at the predicted probability.
      const double p = predicted.value,
                   se = std::hypot(std::sqrt(p * (1.0 - p) / n), predicted.mcse);
      std::printf("predicted %.4f +- %.4f, same tests %.4f, engine %.4f, difference %.4f +- %.4f; ",
                  p, predicted.mcse, same / n, engine / n, engine / n - p, se);
    };
    std::printf("%s: %d tests, %d damaged; threshold P %.4f. Detected: ", name.c_str(), done,
                damaged, threshold);
    compared(design.scores.detection, by_plan, detected);
    std::printf("right place: ");
    compared(design.scores.right_place, right_by_plan, right);
    std::printf("truth missed in %d; rms of P %.4f\n", missed, std::sqrt(squares / done));
    std::fflush(stdout);
  };
  const auto begun = std::clock();
  std::printf("{\"case\": \"%s\", \"sensors\": [", name.c_str());
  for (const int sensor : design.design.sensors) std::printf(" %d", sensor);
  std::printf(" ]}\n");
  for (int done = 0; done < tests; ++done) {
    const int i = first_test + done;
    const std::uint64_t number = kFirstCheck + static_cast<std::uint64_t>(i);
    const std::vector<Scenario> scenario = {model.source().draw(number, solver)};
    const TestOutcome outcome =
        simulate_tests(model.source(), prepared, scenario, plan.tolerance)[0];
    inference::Options own{.seed = 1 + number, .threads = options.threads, .quick = quick};
    if (quick) own.searches = std::max(own.searches, 200);
    const EngineOutcome engine = identify(plan, model.source(), design.design, number, own);
    const double p = 1.0 / (1.0 + std::exp(-outcome.log_odds));
    std::printf(
        "{\"case\": \"%s\", \"test\": %d, \"model\": %d, \"plan\": %.5f, \"engine\": %.5f, "
        "\"plan right\": %d, \"engine right\": %d, \"truth gain\": %.2f, \"processor seconds\": "
        "%.1f}\n",
        name.c_str(), i, outcome.model, p, engine.probability_damaged, outcome.right, engine.right,
        engine.truth_gain, static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
    squares += std::pow(p - engine.probability_damaged, 2);
    if (index(outcome.model) != intact) {
      ++damaged;
      missed += engine.truth_gain > kMissed;
      detected += engine.probability_damaged > threshold;
      right += engine.probability_damaged > threshold && engine.right;
      by_plan += outcome.log_odds > design.scores.threshold;
      right_by_plan += outcome.log_odds > design.scores.threshold && outcome.right;
    }
    std::fflush(stdout);
    if ((done + 1) % 30 == 0 || done + 1 == tests) print(done + 1);
  }
  return 0;
}

/// Tests whether the engine finds two true damages. Prints a line for each test with the
/// log-likelihood of the truth minus the largest log-likelihood of a draw. A large positive
/// difference means that the search missed the true damage.
int truths(const std::string& name, int tests, int searches) {
  const PlanCase plan = named(name);
  const PlanOptions options{.scenarios = 4000, .threads = base::thread_count(0)};
  const PlanModel model(plan, options);
  const TestDesign design = search_sensors(plan, options).best.front().design;
  const PreparedDesign prepared =
      prepare(model.structure(), model.predictions(), plan.noise, design);
  PlannedStructure::Solver solver(model.structure());
  int both = 0, by_plan = 0, by_engine = 0, missed = 0;
  for (int i = 0; i < tests; ++i) {
    const std::uint64_t number = (std::uint64_t{1} << 40) + static_cast<std::uint64_t>(i);
    const std::vector<Scenario> scenario = {model.source().draw(number, solver)};
    if (scenario[0].defects.size() < 2) continue;
    const TestOutcome outcome =
        simulate_tests(model.source(), prepared, scenario, plan.tolerance)[0];
    inference::Options own{.seed = number, .threads = options.threads, .quick = true};
    if (searches > 0) own.searches = searches;
    const auto begun = std::clock();
    const EngineOutcome engine = identify(plan, model.source(), design, number, own);
    ++both;
    by_plan += outcome.right;
    by_engine += engine.right;
    missed += engine.truth_gain > 3.0;
    std::printf(
        "{\"test\": %d, \"plan right\": %d, \"located\": %.3f, \"engine right\": %d, \"model\": "
        "%d, "
        "\"truth minus best\": %.2f, \"processor seconds\": %.1f}\n",
        i, outcome.right, outcome.located, engine.right, engine.model, engine.truth_gain,
        static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
    std::fflush(stdout);
  }
  std::printf(
      "%s: %d tests with two damages; right by the plan %d, by the engine %d; truth missed "
      "in %d\n",
      name.c_str(), both, by_plan, by_engine, missed);
  return 0;
}

/// A random plane frame with a noise level at which about half the damages are found.
PlanCase random_plan(int number) {
  base::Random random(20'26, 0, static_cast<std::uint64_t>(number), base::Purpose::test);
  std::vector<double> x = {0.0}, y = {0.0};
  const int bays = 1 + random.index(2), storeys = 1 + random.index(3);
  for (int b = 0; b < bays; ++b) x.push_back(x.back() + 3.0 + 3.0 * random.uniform());
  for (int s = 0; s < storeys; ++s) y.push_back(y.back() + 2.8 + 1.5 * random.uniform());
  PlanCase plan = of_structure(plane_frame(x, y, 6), 1 + random.index(2), 3 + random.index(3),
                               4 + random.index(4), true, 60);
  plan.noise.seconds = plan.noise.reference_seconds = std::exp(4.0 + 3.5 * random.uniform());
  plan.noise.shape_sd = 0.01 + 0.03 * random.uniform();
  return plan;
}

/// Outcomes of two designs for the same simulated tests.
struct Paired {
  TestScores scores[2];
  double difference = 0.0, error = 0.0;  // right_place of the first minus the second design
};

Paired compare(const PlanCase& plan, const PlanModel& model, const TestDesign& one,
               const TestDesign& other, int scenarios, std::uint64_t first, int threads) {
  const PreparedDesign designs[2] = {
      prepare(model.structure(), model.predictions(), plan.noise, one),
      prepare(model.structure(), model.predictions(), plan.noise, other)};
  const std::vector<Scenario> drawn = model.source().draw(first, scenarios, threads);
  constexpr int kBlock = 250;
  const int blocks = (scenarios + kBlock - 1) / kBlock;
  std::vector<std::vector<TestOutcome>> found(index(2 * blocks));
  base::parallel_for(2 * blocks, threads, [&](int b) {
    const int begin = b / 2 * kBlock, size = std::min(kBlock, scenarios - begin);
    found[index(b)] =
        simulate_tests(model.source(), designs[b % 2],
                       std::span(drawn).subspan(index(begin), index(size)), plan.tolerance);
  });
  std::vector<TestOutcome> all[2];
  for (int b = 0; b < 2 * blocks; ++b)
    all[b % 2].insert(all[b % 2].end(), found[index(b)].begin(), found[index(b)].end());
  Paired out;
  for (int d : {0, 1}) out.scores[d] = summarise(all[d], model.source().models(), plan.false_alarm);
  const auto& models = model.source().models();
  std::vector<double> n(models.size()), sum(models.size()), squares(models.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const auto m = index(drawn[i].truth.model);
    double right[2];
    for (int d : {0, 1})
      right[d] = all[d][i].right && all[d][i].log_odds > out.scores[d].threshold ? 1.0 : 0.0;
    n[m] += 1.0;
    sum[m] += right[0] - right[1];
    squares[m] += std::abs(right[0] - right[1]);
  }
  double damaged = 0.0, variance = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m)
    if (std::reduce(models[m].counts.begin(), models[m].counts.end()) > 0)
      damaged += models[m].prior;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (std::reduce(models[m].counts.begin(), models[m].counts.end()) == 0) continue;
    const double share = models[m].prior / damaged, mean = sum[m] / n[m];
    out.difference += share * mean;
    variance += share * share * (squares[m] / n[m] - mean * mean) / n[m];
  }
  out.error = std::sqrt(variance);
  return out;
}

int layouts(int structures, int first) {
  double better = 0.0, mean = 0.0;
  int used = 0;
  for (int number = first; used < structures && number < first + 20 * structures; ++number) {
    const PlanCase plan = random_plan(number);
    const PlanOptions options{.scenarios = 20'000, .seed = 5, .threads = base::thread_count(0)};
    const PlanModel model(plan, options);
    const TestDesign classical{
        .sensors = effective_independence(model.structure().intact_shapes(), plan.choose)};
    const auto scored = [&](const std::vector<TestDesign>& designs, int scenarios,
                            std::uint64_t from) {
      return score_designs(model.source(), model.predictions(), plan.noise, designs,
                           {.scenarios = scenarios,
                            .false_alarm = plan.false_alarm,
                            .tolerance = plan.tolerance,
                            .threads = options.threads},
                           from);
    };
    // Structures in which effective independence gives between 20 and 80 %.
    const double quick = scored({classical}, 3000, 1u << 30)[0].right_place.value;
    if (!(quick > 0.2 && quick < 0.8)) continue;
    // As the program: the best design of the search by further simulated tests. The comparison uses
    // other tests.
    const SensorChoice choice = search_sensors(plan, options);
    std::vector<TestDesign> designs = {classical};
    for (const RankedDesign& d : choice.best) designs.push_back(d.design);
    const auto scores = scored(designs, 10'000, 0);
    std::size_t best = 0;
    for (std::size_t d = 1; d < designs.size(); ++d)
      if (scores[d].right_place.value > scores[best].right_place.value) best = d;
    const Paired pair =
        compare(plan, model, designs[best], classical, 20'000, 1u << 20, options.threads);
    better += pair.difference > 2.0 * pair.error                           ? 1.0
              : best == 0 || std::abs(pair.difference) <= 2.0 * pair.error ? 0.5
                                                                           : 0.0;
    mean += pair.difference;
    ++used;
    std::printf(
        "{\"structure\": %d, \"candidates\": %zu, \"choose\": %d, \"modes\": %d, \"most\": %d, "
        "\"chosen\": %.4f, \"effective independence\": %.4f, \"difference\": %.4f, \"se\": %.4f, "
        "\"detected\": %.4f, \"detected by effective independence\": %.4f, \"information\": %.4f, "
        "\"information by effective independence\": %.4f}\n",
        number, plan.structure.candidates.size(), plan.choose, model.structure().modes(),
        plan.damage_case.kinds[0].max_count, pair.scores[0].right_place.value,
        pair.scores[1].right_place.value, pair.difference, pair.error,
        pair.scores[0].detection.value, pair.scores[1].detection.value,
        pair.scores[0].information.value, pair.scores[1].information.value);
    std::fflush(stdout);
  }
  std::printf("%d structures: better in %.1f %%, mean difference %.4f\n", used,
              100.0 * better / used, mean / used);
  return 0;
}

int time_it(int scenarios, int threads) {
  const fem::Structure frame = plane_frame({0.0, 4.0, 9.0, 13.0}, {0.0, 3.0, 6.5}, 6);
  PlanCase plan = of_structure(frame, 2, 8, 10, true, 60);
  plan.structure.candidates = sensors_of(frame, true, 60, true);
  const auto begun = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  const auto processor = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const PlanOptions options{.scenarios = scenarios,
                            .threads = base::thread_count(threads),
                            .progress = [&](const char* stage, double f) {
                              std::fprintf(stderr, "%6.1f s, processor %6.1f s: %s %.0f %%\n",
                                           now(), processor(), stage, 100.0 * f);
                            }};
  const PlanModel model(plan, options);
  std::printf("%zu candidates, %zu places, model ready after %.1f s\n",
              plan.structure.candidates.size(), model.structure().places().size(), now());
  const PlanFindings findings = make_plan(plan, model, options);
  std::printf("all after %.1f s, processor %.1f s; compared %ld designs with up to %d scenarios\n",
              now(), processor(), findings.search.compared, findings.search.scenarios);
  for (const ScoredDesign& d : findings.designs)
    std::printf("%s: information %.4f +- %.4f, detection %.4f, right place %.4f\n", d.name.c_str(),
                d.scores.information.value, d.scores.information.mcse, d.scores.detection.value,
                d.scores.right_place.value);
  for (const ScoredDesign& d : findings.others)
    std::printf("%s: information %.4f, detection %.4f, right place %.4f\n", d.name.c_str(),
                d.scores.information.value, d.scores.detection.value, d.scores.right_place.value);
  std::printf("interaction %.3f, %.3f\n", findings.interaction_median, findings.interaction_high);
  return 0;
}

/// Processor time for the scores of one design, without the search.
int score_time(int scenarios) {
  const fem::Structure frame = plane_frame({0.0, 4.0, 9.0, 13.0}, {0.0, 3.0, 6.5}, 6);
  PlanCase plan = of_structure(frame, 2, 8, 10, true, 60);
  plan.structure.candidates = sensors_of(frame, true, 60, true);
  const PlanOptions options{.scenarios = scenarios};
  const PlanModel model(plan, options);
  const TestDesign design{
      .sensors = effective_independence(model.structure().intact_shapes(), plan.choose)};
  const PreparedDesign prepared =
      prepare(model.structure(), model.predictions(), plan.noise, design);
  const std::vector<Scenario> drawn = model.source().draw(0, scenarios, 1);
  const auto begun = std::clock();
  const auto outcomes = simulate_tests(model.source(), prepared, drawn, plan.tolerance);
  const double seconds = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  const TestScores s = summarise(outcomes, model.source().models(), plan.false_alarm);
  std::printf("%.1f us a test; information %.5f, detection %.5f, right place %.5f\n",
              1e6 * seconds / scenarios, s.information.value, s.detection.value,
              s.right_place.value);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "agreement" && argc > 3)
    return agreement(argv[2], std::atoi(argv[3]), argc > 4, argc > 5 ? std::atoi(argv[5]) : 0);
  if (what == "layouts" && argc > 2)
    return layouts(std::atoi(argv[2]), argc > 3 ? std::atoi(argv[3]) : 0);
  if (what == "truths" && argc > 3)
    return truths(argv[2], std::atoi(argv[3]), argc > 4 ? std::atoi(argv[4]) : 0);
  if (what == "score") return score_time(argc > 2 ? std::atoi(argv[2]) : 5000);
  if (what == "time")
    return time_it(argc > 2 ? std::atoi(argv[2]) : 100'000, argc > 3 ? std::atoi(argv[3]) : 0);
  std::cerr << "usage: planning_study agreement beam|frame|space TESTS [quick [FIRST]] | "
               "truths beam|frame|space TESTS [SEARCHES] | layouts STRUCTURES [FIRST] | "
               "time [SCENARIOS [THREADS]] | score [SCENARIOS]\n";
  return 64;
}
