// Damage of a frame: posteriors compared with brute-force sums over (member, s, severities) that do
// not use the engine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/crack.hpp"
#include "identification/structural/defects/joint.hpp"
#include "identification/structural/defects/storey.hpp"

namespace wheeltap::identification {
namespace {

/// Two bays of different width, two storeys: ten members, the beams joined semi-rigidly.
fem::Structure frame() {
  const fem::Material steel{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const fem::MemberSection section{
      .area = 5e-3, .second_moment_y = 1.7e-5, .shear_coefficient_z = 0.85, .depth = 0.2};
  fem::Structure s{.dimension = 2, .nodes = {}, .members = {}};
  const double x[] = {0.0, 4.0, 9.0}, y[] = {0.0, 3.0, 6.5};
  for (int level = 0; level < 3; ++level)
    for (int column = 0; column < 3; ++column)
      s.nodes.push_back({std::string(1, static_cast<char>('A' + column)) + std::to_string(level),
                         {x[column], y[level], 0.0}});
  const auto add = [&](int a, int b, double joint) {
    const double length = fem::norm(fem::difference(s.nodes[static_cast<std::size_t>(b)].at,
                                                    s.nodes[static_cast<std::size_t>(a)].at));
    fem::Member m{.name = s.nodes[static_cast<std::size_t>(a)].name + "-" +
                          s.nodes[static_cast<std::size_t>(b)].name,
                  .nodes = {a, b},
                  .elements = 6,
                  .pieces = {{.to = length, .material = steel, .section = section}}};
    for (fem::MemberEnd& end : m.ends) end.rotation.fill(joint);
    s.members.push_back(m);
  };
  for (int level = 0; level < 2; ++level)
    for (int column = 0; column < 3; ++column)
      add(3 * level + column, 3 * level + column + 3, fem::MemberEnd::kRigid);
  for (int level = 1; level < 3; ++level)
    for (int bay = 0; bay < 2; ++bay) add(3 * level + bay, 3 * level + bay + 1, 6e6);
  for (int foot = 0; foot < 3; ++foot)
    s.supports.push_back({.node = foot, .fix = {true, true, true, true, true, true}});
  return s;
}

std::vector<int> all_members(const fem::Mesh& mesh) {
  std::vector<int> list;
  for (std::size_t m = 0; m < mesh.structure().members.size(); ++m)
    list.push_back(static_cast<int>(m));
  return list;
}

/// At most one defect of a type, anywhere on a line with equal weights.
DefectKind at_most_one(const DefectType& type, std::string name, SiteLine line,
                       const inference::Prior& severity) {
  DefectKind kind{.type = &type,
                  .name = name,
                  .plural = name + "s",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = severity};
  kind.line = std::move(line);
  return kind;
}

DamageCase crack_and_joint(const fem::Structure& structure) {
  const fem::Mesh mesh(structure);
  DamageCase out;
  out.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = structure});
  DefectKind crack =
      at_most_one(defects::kCrack, "crack", SiteLine::of_members(mesh, all_members(mesh)),
                  inference::Prior(inference::Uniform{0.05, 0.6}));
  DefectKind joint =
      at_most_one(defects::kJoint, "joint",
                  SiteLine::of_points({3, 4, 5, 6, 7, 8}, {"A1", "B1", "C1", "A2", "B2", "C2"}),
                  inference::Prior(inference::Uniform{0.0, 0.9}));
  crack.truth = {{.location = crack.line.x_of(7, 2.2), .severity = 0.14}};
  joint.truth = {{.location = joint.line.x_of(3, 0.0), .severity = 0.12}};
  out.kinds = {crack, joint};
  out.simulation = Simulation{.modes = 12, .cv = 0.001, .seed = 4};
  out.data = simulate(out, 4);
  return out;
}

/// log of the integral of exp(f) over a box, by midpoints of cells that are halved in every
/// direction where they contribute. `change`: the change of the sum by the last halving.
struct Sum {
  double log_integral, change;  // log of the sum, and log ratio of the last halving
};
template <class F>
Sum integrate(const F& f, const std::vector<std::pair<double, double>>& box,
              const std::vector<int>& first_cells, int halvings) {
  struct Cell {
    std::vector<double> low, width;
    double log_value;  // at the midpoint, times the volume
  };
  const std::size_t d = box.size();
  const auto value = [&](Cell& cell) {
    std::vector<double> x(d);
    double volume = 0.0;
    for (std::size_t k = 0; k < d; ++k) {
      x[k] = cell.low[k] + 0.5 * cell.width[k];
      volume += std::log(cell.width[k]);
    }
    cell.log_value = f(x) + volume;
  };
  std::vector<Cell> cells(1);
  for (const auto& [low, high] : box) {
    cells[0].low.push_back(low);
    cells[0].width.push_back(high - low);
  }
  for (std::size_t k = 0; k < d; ++k) {
    std::vector<Cell> finer;
    for (const Cell& cell : cells)
      for (int i = 0; i < first_cells[k]; ++i) {
        finer.push_back(cell);
        finer.back().width[k] /= first_cells[k];
        finer.back().low[k] += i * finer.back().width[k];
      }
    cells = std::move(finer);
  }
  for (Cell& cell : cells) value(cell);
  const auto total = [&] {
    double top = -INFINITY, sum = 0.0;
    for (const Cell& cell : cells) top = std::max(top, cell.log_value);
    for (const Cell& cell : cells) sum += std::exp(cell.log_value - top);
    return top + std::log(sum);
  };
  double before = total(), now = before;
  for (int h = 0; h < halvings; ++h) {
    before = now;
    // Neighbours of contributing cells may hide a peak between midpoints: use a wide margin first.
    const double worth =
        before - (h < 1 ? 25.0 : 6.0) - std::log(static_cast<double>(cells.size()));
    std::vector<Cell> finer;
    for (Cell& cell : cells) {
      if (cell.log_value < worth) {
        finer.push_back(std::move(cell));
        continue;
      }
      for (std::size_t corner = 0; corner < (std::size_t{1} << d); ++corner) {
        Cell child = cell;
        for (std::size_t k = 0; k < d; ++k) {
          child.width[k] *= 0.5;
          if ((corner >> k) & 1) child.low[k] += child.width[k];
        }
        value(child);
        finer.push_back(std::move(child));
      }
    }
    cells = std::move(finer);
    now = total();
  }
  return {now, now - before};
}

TEST(StructureDamage, ACrackAndALooseJointInAFrameOfTenMembers) {
  const DamageCase damage_case = crack_and_joint(frame());
  const fem::Mesh mesh(frame());
  const fem::StructureReanalysis reanalysis(
      std::make_shared<const fem::Discretisation>(mesh.discretisation()), 12);
  auto workspace = reanalysis.make_workspace();
  const FrequencyData& data = damage_case.data;
  const auto log_likelihood = [&](const fem::StructureDefects& defects) {
    std::vector<double> f(12);
    reanalysis.solve(fem::change_of(mesh, defects), workspace, {.frequencies_hz = f});
    double sum = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double r = (data.frequencies_hz[i] - f[i]) / data.sd_hz[i];
      sum -= 0.5 * r * r;
    }
    return sum;
  };
  const fem::CrackLaw* law = fem::find_crack_law("tada");
  const double depth_density = -std::log(0.55), reduction_density = -std::log(0.9);
  double all_length = 0.0;
  for (int m = 0; m < 10; ++m) all_length += mesh.member_length(m);

  // Evidences of: no damage, a joint, a crack, both; and the share of the last two on each member.
  double evidence[4] = {};
  evidence[0] = std::exp(log_likelihood({}));
  double moved[4] = {};  // by the last halving
  const auto add = [&](int model, const Sum& sum, double log_weight) {
    const double value = std::exp(sum.log_integral + log_weight);
    evidence[model] += value;
    moved[model] -= value * std::expm1(-sum.change);
    return value;
  };
  std::map<int, double> by_member;
  for (int node = 3; node < 9; ++node) {
    add(1,
        integrate(
            [&](const auto& x) {
              return log_likelihood({.joints = {{node, x[0]}}});
            },
            {{0.0, 0.9}}, {64}, 6),
        reduction_density - std::log(6.0));
  }
  for (int m = 0; m < 10; ++m) {
    const double length = mesh.member_length(m);
    by_member[m] += add(2,
                        integrate(
                            [&](const auto& x) {
                              return log_likelihood({.cracks = {{m, x[0], x[1], law}}});
                            },
                            {{0.0, length}, {0.05, 0.6}}, {24, 16}, 4),
                        depth_density - std::log(all_length));
    for (int node = 3; node < 9; ++node) {
      by_member[m] += add(
          3,
          integrate(
              [&](const auto& x) {
                return log_likelihood({.cracks = {{m, x[0], x[1], law}}, .joints = {{node, x[2]}}});
              },
              {{0.0, length}, {0.05, 0.6}, {0.0, 0.9}}, {16, 8, 6}, 3),
          depth_density - std::log(all_length) + reduction_density - std::log(6.0));
    }
  }
  const double sum = evidence[0] + evidence[1] + evidence[2] + evidence[3];
  ASSERT_GT(sum, 0.0);
  const double before = sum - moved[0] - moved[1] - moved[2] - moved[3];
  for (int model = 0; model < 4; ++model) {
    EXPECT_NEAR((evidence[model] - moved[model]) / before, evidence[model] / sum, 1e-3)
        << "the reference has not converged";
  }

  const auto problem = make_damage_problem(damage_case, {});
  const auto posterior = inference::reversible_jump(problem->problem, {.seed = 5});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 5);
  EXPECT_TRUE(found.sampling.verdict.converged);
  for (const ModelFinding& model : found.models) {
    const double exact = evidence[2 * model.counts[0] + model.counts[1]] / sum;
    EXPECT_NEAR(model.probability(), exact, 4.0 * model.standing.mcse + 2e-3) << model.name;
  }
  // Place of the crack: the expected number on each member.
  const KindFinding& cracks = found.kinds[0];
  const SiteLine& line = damage_case.kinds[0].line;
  std::map<int, double> expected;
  for (std::size_t c = 0; c < cracks.expected.size(); ++c) {
    const int stretch = line.stretch_of_cell(static_cast<int>(c));
    expected[line.stretches()[static_cast<std::size_t>(stretch)].site] += cracks.expected[c];
  }
  for (int m = 0; m < 10; ++m) {
    EXPECT_NEAR(expected[m], by_member[m] / sum, 0.03) << "member " << m;
  }
}

/// A chain of storeys, compared with the sum over storeys and reductions.
TEST(StructureDamage, ASoftStorey) {
  fem::LumpedChain chain{.masses = {1.0, 1.1, 0.9, 1.0}, .links = {}};
  for (int i = 0; i < 4; ++i)
    chain.links.push_back({"storey " + std::to_string(i + 1), {i, i + 1}, 1000.0 + 100.0 * i});
  DamageCase damage_case;
  damage_case.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = chain});
  DefectKind storey = at_most_one(
      defects::kStorey, "storey",
      SiteLine::of_points({0, 1, 2, 3}, {"storey 1", "storey 2", "storey 3", "storey 4"}),
      inference::Prior(inference::Uniform{0.0, 0.8}));
  storey.truth = {{.location = 2.5, .severity = 0.2}};
  damage_case.kinds = {storey};
  damage_case.simulation = Simulation{.modes = 3, .cv = 0.03, .seed = 2};
  damage_case.data = simulate(damage_case, 2);

  double evidence[2] = {};
  std::map<int, double> by_storey;
  const auto likelihood = [&](int link, double reduction) {
    fem::LumpedChain damaged = chain;
    if (link >= 0) damaged.links[static_cast<std::size_t>(link)].stiffness *= 1.0 - reduction;
    const fem::StructureModes modes = fem::structure_modes(fem::discretise(damaged), 3);
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double r = (damage_case.data.frequencies_hz[i] -
                        modes.frequencies_hz[static_cast<Eigen::Index>(i)]) /
                       damage_case.data.sd_hz[i];
      sum -= 0.5 * r * r;
    }
    return std::exp(sum);
  };
  evidence[0] = likelihood(-1, 0.0);
  constexpr int kPoints = 400;
  for (int link = 0; link < 4; ++link)
    for (int i = 0; i < kPoints; ++i) {
      const double part = likelihood(link, 0.8 * (i + 0.5) / kPoints) / kPoints / 4.0;
      evidence[1] += part;
      by_storey[link] += part;
    }
  const double sum = evidence[0] + evidence[1];
  const auto problem = make_damage_problem(damage_case, {});
  const auto posterior = inference::reversible_jump(problem->problem, {.seed = 3});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 3);
  EXPECT_TRUE(found.sampling.verdict.converged);
  for (const ModelFinding& model : found.models)
    EXPECT_NEAR(model.probability(), evidence[model.counts[0]] / sum,
                4.0 * model.standing.mcse + 1e-4)
        << model.name;
  for (int link = 0; link < 4; ++link)
    EXPECT_NEAR(found.kinds[0].expected[static_cast<std::size_t>(link)], by_storey[link] / sum,
                0.02)
        << link;
}

}  // namespace
}  // namespace wheeltap::identification
