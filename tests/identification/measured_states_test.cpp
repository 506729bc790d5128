// Measured structures of ../shared/data in several states: the four-mass structure of Los Alamos
// with a softened storey or an added mass, and the steel beam with a moving roller. Skipped if the
// data are absent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "base/constants.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/floor_mass.hpp"
#include "identification/structural/defects/storey.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

const std::filesystem::path kShared = std::filesystem::path(WHEELTAP_SHARED_DIR) / "data";

/// Rows of a CSV file without quotes, without the header.
std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::vector<std::vector<std::string>> out;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    out.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) out.back().push_back(cell);
  }
  return out;
}

ModalData measured_frequencies(std::vector<double> f, const std::vector<double>& sd) {
  ModalData out{.frequencies_hz = std::move(f)};
  out.covariance = modal::diagonal(sd);
  return out;
}

// ---- four masses -------------------------------------------------------------------------------

/// Medians of the second and third flexible mode. The scatter is twice that of a median of n lines,
/// because lines of a periodogram cluster within a record.
std::map<int, ModalData> lanl_states() {
  std::map<int, ModalData> out;
  for (const auto& row : rows_of(kShared / "lanl-3story-features/state_summary.csv")) {
    const auto number = [&](std::size_t i) { return std::stod(row[i]); };
    const auto sd = [&](std::size_t i) {
      return 2.0 * 1.25 * number(i) / std::sqrt(number(i + 1));
    };
    out[std::stoi(row[0])] =
        measured_frequencies({kNaN, number(3), number(6)}, {0.0, sd(4), sd(7)});
  }
  return out;
}

/// The chain with its published masses, free base, and 15 % uncertainty of each storey's stiffness.
std::shared_ptr<const StructureModel> lanl_chain() {
  auto model = std::make_shared<StructureModel>();
  fem::LumpedChain chain{.masses = {6.2016, 7.5042, 8.2248, 7.6557}, .links = {}};
  for (int i = 0; i < 3; ++i) {
    const std::string name = "storey " + std::to_string(i + 1);
    chain.links.push_back({name, {i + 1, i + 2}, 440e3});
    model->parameters.push_back(
        {"k" + std::to_string(i + 1), inference::LogNormal{std::log(440e3), 0.15}});
    model->setters.emplace_back([i](AnyStructure& s, double x) {
      std::get<fem::LumpedChain>(s).links[static_cast<std::size_t>(i)].stiffness = x;
    });
  }
  model->nominal = chain;
  return model;
}

DefectKind kind_of(const DefectType& type, std::string name, const std::vector<std::string>& names,
                   const inference::Prior& severity) {
  std::vector<int> sites;
  for (std::size_t i = 0; i < names.size(); ++i) sites.push_back(static_cast<int>(i));
  SiteLine line = SiteLine::of_points(sites, names);
  DefectKind kind{.type = &type,
                  .name = name,
                  .plural = name + "s",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = severity};
  kind.line = std::move(line);
  return kind;
}

struct Lanl {
  DamageFindings found;
  double soft = 0.0, heavy = 0.0;    ///< P(a soft storey), P(an added mass)
  std::vector<double> storeys = {};  ///< expected number of soft storeys
};

/// State `damaged` compared with the healthy states.
Lanl lanl(int damaged, const std::vector<int>& healthy, const std::map<int, int>& added,
          bool masses) {
  const auto data = lanl_states();
  auto states = std::make_shared<ObservedStates>();
  states->model = lanl_chain();
  states->unknown = {0, 1, 2};
  for (const int s : healthy) {
    states->list.push_back({.name = "state " + std::to_string(s), .data = data.at(s)});
    if (const auto mass = added.find(s); mass != added.end())
      states->list.back().masses = {
          {.motion = {.dofs = {mass->second}, .coefficients = {1.0}}, .mass = 1.2}};
  }
  states->list.push_back(
      {.name = "state " + std::to_string(damaged), .data = data.at(damaged), .damaged = true});
  for (ObservedState& s : states->list) s.data.discrepancy.value = 0.005;
  DamageCase damage_case;
  damage_case.structure = states->model;
  damage_case.measured = MeasuredModes(states, states->joined());
  damage_case.kinds = {
      kind_of(defects::kStorey, "soft storey", {"storey 1", "storey 2", "storey 3"},
              inference::Prior(inference::Uniform{0.0, 0.9})),
      kind_of(defects::kFloorMass, "added mass", {"base", "floor 1", "floor 2", "floor 3"},
              inference::Prior(inference::Uniform{0.0, 2.5}))};
  if (!masses) damage_case.kinds.pop_back();
  damage_case.data.frequencies_hz = damage_case.modal()->frequencies_hz;
  damage_case.data.discrepancy_cv = 0.005;
  for (std::size_t i = 0; i < damage_case.data.frequencies_hz.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    damage_case.data.sd_hz.push_back(std::sqrt(damage_case.modal()->covariance(at, at)));
  }
  const auto problem = make_damage_problem(damage_case, {});
  const int draws = std::getenv("WHEELTAP_LONG_TESTS") != nullptr ? 8000 : 2000;
  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .chains = 4, .draws = draws});
  Lanl out{.found = damage_findings(*problem, posterior, {}, 1)};
  for (const ModelFinding& m : out.found.models) {
    if (m.counts[0] > 0) out.soft += m.probability();
    if (masses && m.counts[1] > 0) out.heavy += m.probability();
  }
  out.storeys = out.found.kinds[0].expected;
  std::printf(
      "  state %d: P(soft storey) %.3f (storeys %.2f %.2f %.2f), P(added mass) %.3f, p %.2g\n",
      damaged, out.soft, out.storeys[0], out.storeys[1], out.storeys[2], out.heavy,
      out.found.fit ? out.found.fit->posterior_predictive_p : kNaN);
  for (const ModelFinding& m : out.found.models) {
    std::printf("    %-32s %.3f", m.name.c_str(), m.probability());
    for (const ParameterFinding& p : m.parameters)
      if (p.unknown.kind >= 0 && p.unknown.parameter == 1)
        std::printf("  %s %.3f to %.3f", p.unknown.label.c_str(), p.estimate.q2_5,
                    p.estimate.q97_5);
    std::printf("\n");
  }
  return out;
}

#define SKIP_WITHOUT(folder) \
  if (!std::filesystem::exists(kShared / (folder))) GTEST_SKIP() << (folder) << " does not exist"

/// The reduction in the model with one soft storey only.
const Marginal& reduction_of(const Lanl& run) {
  for (const ModelFinding& m : run.found.models)
    if (m.counts[0] == 1) return *m.find(0, 0, 1);
  throw std::logic_error("no such model");
}

// A column of half the thickness removes .219 of a storey's stiffness, two remove .4375. With two
// frequencies the lowest and the highest storey are indistinguishable, because the chain is nearly
// symmetric: both are named.
TEST(MeasuredStates, SoftStoreysOfTheFourMasses) {
  SKIP_WITHOUT("lanl-3story-features");
  for (const auto& [state, truth] : std::map<int, double>{{4, 0.21875}, {5, 0.4375}}) {
    const Lanl run = lanl(state, {1}, {}, false);
    EXPECT_GT(run.soft, 0.99) << state;
    EXPECT_GT(run.storeys[0], 0.2) << state;
    EXPECT_LT(run.storeys[1], 0.1) << state;
    EXPECT_LE(reduction_of(run).q2_5, truth) << state;
    EXPECT_GE(reduction_of(run).q97_5, truth) << state;
    const auto told = std::ranges::find_if(run.found.remarks, [](const Remark& r) {
      return std::holds_alternative<remark::RivalPlaces>(r);
    });
    ASSERT_NE(told, run.found.remarks.end()) << state;
    std::set<std::string> rivals;
    for (const auto& place : std::get<remark::RivalPlaces>(*told).places) rivals.insert(place.name);
    EXPECT_EQ(rivals, (std::set<std::string>{"storey 1", "storey 3"})) << state;
  }
}

// The healthy frame, with 1.2 kg on its base and on its first floor in the reference states, has no
// damage without them; a bumper that is barely touched does not change this.
TEST(MeasuredStates, TheHealthyFourMasses) {
  SKIP_WITHOUT("lanl-3story-features");
  const Lanl bare = lanl(1, {2, 3}, {{2, 0}, {3, 1}}, true);
  EXPECT_LT(bare.soft, 0.2);
  EXPECT_LT(bare.heavy, 0.2);
  const Lanl bumper = lanl(10, {1}, {}, true);
  EXPECT_LT(bumper.soft, 0.2);
  EXPECT_LT(bumper.heavy, 0.2);
}

// 1.2 kg on the base or on the first floor: distinguished from softening, or both are listed.
TEST(MeasuredStates, AddedMassesOfTheFourMasses) {
  SKIP_WITHOUT("lanl-3story-features");
  for (const int state : {2, 3}) {
    const Lanl run = lanl(state, {1}, {}, true);
    EXPECT_GT(run.heavy, 0.2) << state;
    EXPECT_GT(run.soft + run.heavy, 0.9) << state;
  }
}

// ---- the beam with a roller --------------------------------------------------------------------

struct Roller {
  double place_mm, f1, f2;
};

/// A steel beam, clamped by a rotational spring. Unknown: the roller's zero, E, the spring, and
/// mass and place of the sensors.
std::shared_ptr<const StructureModel> roller_beam() {
  auto model = std::make_shared<StructureModel>();
  const fem::Material steel{.young = 200e9, .poisson = 0.3, .density = 7800.0};
  constexpr double kWidth = 0.051, kHeight = 0.00666;
  const fem::MemberSection section{.area = kWidth * kHeight,
                                   .second_moment_y = kWidth * kHeight * kHeight * kHeight / 12.0,
                                   .shear_coefficient_z = 5.0 / 6.0,
                                   .depth = kHeight};
  fem::Structure s{.dimension = 2,
                   .nodes = {{"clamp", {0, 0, 0}},
                             {"roller", {0.1, 0, 0}},
                             {"sensor", {0.34, 0, 0}},
                             {"tip", {0.501, 0, 0}}},
                   .members = {}};
  s.axial = false;
  for (int i = 0; i < 3; ++i)
    s.members.push_back({.name = "piece " + std::to_string(i + 1),
                         .nodes = {i, i + 1},
                         .elements = 4,
                         .pieces = {{.to = 1.0, .material = steel, .section = section}}});
  s.supports.push_back({.node = 0, .fix = {true, true}, .stiffness = {0, 0, 0, 0, 0, 1e4}});
  s.supports.push_back({.node = 1, .fix = {false, true}});
  s.masses.push_back({.node = 2, .mass = 0.03});
  model->nominal = s;
  const auto lengths = [](AnyStructure& any, std::span<const double>) {
    auto& beam = std::get<fem::Structure>(any);
    for (std::size_t m = 0; m < 3; ++m)
      beam.members[m].pieces[0].to = beam.nodes[m + 1].at[0] - beam.nodes[m].at[0];
  };
  lengths(model->nominal, {});
  const auto add = [&](std::string name, const inference::Prior& prior, auto set) {
    model->parameters.push_back({std::move(name), prior});
    model->setters.emplace_back(
        [set](AnyStructure& any, double x) { set(std::get<fem::Structure>(any), x); });
  };
  add("E", inference::LogNormal{std::log(200e9), 0.05}, [](fem::Structure& b, double x) {
    for (auto& m : b.members) m.pieces[0].material.young = x;
  });
  add("clamp", inference::LogUniform{1e2, 1e6},
      [](fem::Structure& b, double x) { b.supports[0].stiffness[5] = x; });
  add("offset", inference::Normal{0.0, 0.01}, [](fem::Structure& b, double x) {
    b.nodes[0].at[0] = -x;
    b.nodes[3].at[0] = 0.501 - x;
  });
  add("sensor mass", inference::LogUniform{0.005, 0.2},
      [](fem::Structure& b, double x) { b.masses[0].mass = x; });
  add("sensor place", inference::Uniform{0.25, 0.42},
      [](fem::Structure& b, double x) { b.nodes[2].at[0] = x; });
  add("roller", inference::Uniform{0.04, 0.18},
      [](fem::Structure& b, double x) { b.nodes[1].at[0] = x; });
  model->dependent.push_back(lengths);
  return model;
}

TEST(MeasuredStates, ARollerBeamPredictsOtherPlaces) {
  SKIP_WITHOUT("dropbear-roller-beam");
  auto states = std::make_shared<ObservedStates>();
  states->model = roller_beam();
  states->unknown = {0, 1, 2, 3, 4};
  states->known = {5};
  std::vector<Roller> rows;
  for (const auto& row : rows_of(kShared / "dropbear-roller-beam/frequency_vs_roller_summary.csv"))
    rows.push_back({std::stod(row[1]), std::stod(row[3]), std::stod(row[6])});
  ASSERT_EQ(rows.size(), 6U);
  for (const std::size_t i : {0U, 1U, 4U, 5U, 2U, 3U}) {
    const Roller& r = rows[i];
    const bool held_out = i == 2 || i == 3;
    ObservedState state{.name = std::to_string(static_cast<int>(std::lround(r.place_mm))) + " mm"};
    state.known = {1e-3 * r.place_mm};
    if (held_out) {
      state.data = measured_frequencies({kNaN, kNaN}, {0.0, 0.0});
      state.data.held_out_hz = {r.f1, r.f2};
    } else {
      state.data = measured_frequencies({r.f1, r.f2}, {0.001 * r.f1, 0.003 * r.f2});
    }
    state.data.discrepancy.prior = inference::LogUniform{1e-3, 0.05};
    states->list.push_back(std::move(state));
  }
  UpdateCase update_case{.title = "roller", .structure = states->model};
  update_case.data = states->joined();
  update_case.states = states;
  const auto problem = make_update_problem(std::move(update_case));
  const auto posterior = inference::reversible_jump(
      problem->problem, {.seed = 1, .chains = 4, .warmup = 2000, .draws = 2000, .thin = 2});
  const UpdateFindings found = update_findings(*problem, posterior, {}, 1);
  for (const auto& p : found.models[0].parameters)
    std::printf("  %-14s %.5g ± %.2g\n", p.unknown.label.c_str(), p.estimate.mean, p.estimate.sd);
  ASSERT_EQ(found.predictions.size(), 4U);
  for (const PredictedMode& p : found.predictions) {
    std::printf("  %s, mode %d: %.3f Hz, %.3f to %.3f, measured %.3f (%+.2f %%)\n", p.state.c_str(),
                p.mode, p.frequency_hz.q50, p.low_hz, p.high_hz, *p.measured_hz,
                100.0 * (p.frequency_hz.q50 / *p.measured_hz - 1.0));
    EXPECT_NEAR(p.frequency_hz.q50 / *p.measured_hz, 1.0, 0.01) << p.state;
    EXPECT_FALSE(p.misses()) << p.state;
  }
  std::printf("  %.3f ms a likelihood\n", 1e3 * problem->seconds_a_likelihood);
}

}  // namespace
}  // namespace wheeltap::identification
