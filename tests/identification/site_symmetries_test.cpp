// Tests of a structure's symmetries, found from its frequencies.
#include "identification/structural/defects/site_symmetries.hpp"

#include <gmock/gmock.h>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/crack.hpp"
#include "identification/structural/defects/joint.hpp"
#include "identification/structural/defects/storey.hpp"

namespace wheeltap::identification {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A portal: two posts and a beam, joined semi-rigidly.
fem::Structure portal() {
  const fem::Material steel{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const fem::MemberSection section{
      .area = 5e-4, .second_moment_y = 4e-9, .shear_coefficient_z = 0.85, .depth = 0.01};
  fem::Structure s{
      .dimension = 2,
      .nodes = {{"A", {0, 0, 0}}, {"B", {0, 1, 0}}, {"C", {1.5, 1, 0}}, {"D", {1.5, 0, 0}}},
      .members = {}};
  int number = 0;
  for (const auto& [name, length] : {std::pair{"left", 1.0}, {"beam", 1.5}, {"right", 1.0}}) {
    s.members.push_back({.name = name,
                         .nodes = {number, number + 1},
                         .elements = 6,
                         .pieces = {{.to = length, .material = steel, .section = section}}});
    ++number;
  }
  for (fem::MemberEnd& end : s.members[1].ends) end.rotation.fill(5e3);
  for (const int foot : {0, 3})
    s.supports.push_back({.node = foot, .fix = {true, true, true, true, true, true}});
  return s;
}

DamageCase cracked(const fem::Structure& structure) {
  const fem::Mesh mesh(structure);
  DamageCase out;
  out.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = structure});
  SiteLine line = SiteLine::of_members(mesh, {0, 1, 2});
  DefectKind crack{.type = &defects::kCrack,
                   .name = "crack",
                   .plural = "cracks",
                   .max_count = 1,
                   .location = inference::Uniform{0.0, line.length()},
                   .severity = inference::Prior(inference::Uniform{0.05, 0.6})};
  crack.line = std::move(line);
  crack.truth = {{.location = crack.line.x_of(0, 0.35), .severity = 0.5}};
  out.kinds = {crack};
  out.simulation = Simulation{.modes = 6, .cv = 0.0002, .seed = 3};
  out.data = simulate(out, 3);
  return out;
}

SiteSymmetries symmetries(const DamageCase& damage_case) {
  return make_damage_problem(damage_case, {})->symmetries;
}

TEST(SiteSymmetries, APortalIsSymmetric) {
  const SiteSymmetries found = symmetries(cracked(portal()));
  EXPECT_THAT(found.maps, SizeIs(1));
  EXPECT_THAT(found.alike, ElementsAre(ElementsAre("left", "right")));
  EXPECT_THAT(found.turned, ElementsAre("beam"));
  const auto& image = found.maps[0].parts[0].image;
  EXPECT_NEAR(image(0.2), 3.3, 1e-12) << "s from the foot of the left post";
  EXPECT_NEAR(image(1.4), 2.1, 1e-12);
  for (const double x : {0.0, 0.3, 1.7, 2.49, 3.5}) EXPECT_NEAR(image(image(x)), x, 1e-9);
}

// The geometry is still symmetric.
TEST(SiteSymmetries, DetectsDifferencesInMassStiffnessSupportOrPrior) {
  fem::Structure mass = portal(), stiffness = portal(), support = portal(), joint = portal();
  mass.masses = {{.node = 1, .mass = 0.01}};
  stiffness.members[0].pieces[0].material.young *= 1.0001;
  support.supports[0] = {.node = 0, .fix = {true, true}};
  joint.members[1].ends[0].rotation.fill(5.01e3);
  int number = 0;
  for (const fem::Structure& s : {mass, stiffness, support, joint})
    EXPECT_THAT(symmetries(cracked(s)).maps, IsEmpty()) << number++;
  DamageCase weighted = cracked(portal());
  weighted.kinds[0].line = SiteLine::of_members(fem::Mesh(portal()), {0, 1, 2}, {2.0, 1.0, 1.0});
  weighted.kinds[0].location = inference::Uniform{0.0, weighted.kinds[0].line.length()};
  EXPECT_THAT(symmetries(weighted).maps, IsEmpty());
}

TEST(SiteSymmetries, ChainsBetweenWalls) {
  const auto find = [](double last) {
    const fem::LumpedChain chain{.masses = {2.0, 3.0, 2.0},
                                 .links = {{"a", {0, 1}, 900.0},
                                           {"b", {1, 2}, 1000.0},
                                           {"c", {2, 3}, 1000.0},
                                           {"d", {3, 0}, last}}};
    DamageCase out;
    out.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = chain});
    DefectKind storey{.type = &defects::kStorey,
                      .name = "storey",
                      .plural = "storeys",
                      .max_count = 1,
                      .location = inference::Uniform{0.0, 4.0},
                      .severity = inference::Prior(inference::Uniform{0.0, 0.8})};
    storey.line = SiteLine::of_points({0, 1, 2, 3}, {"a", "b", "c", "d"});
    out.kinds = {storey};
    out.data.frequencies_hz = {2.0, 4.0};
    out.data.sd_hz = {0.1, 0.1};
    return symmetries(out);
  };
  EXPECT_THAT(find(900.0).alike, ElementsAre(ElementsAre("a", "d"), ElementsAre("b", "c")));
  EXPECT_THAT(find(901.0).alike, IsEmpty());
}

// Every image is listed, with the same probability as the truth.
TEST(SiteSymmetries, TheImageOfACrackIsFound) {
  const auto problem = make_damage_problem(cracked(portal()), {});
  inference::Options options;
  options.seed = 5;
  options.warmup = 2000;
  options.draws = 4000;
  options.threads = 2;
  const inference::Posterior posterior = inference::reversible_jump(problem->problem, options);
  const DamageFindings found = damage_findings(*problem, posterior, {}, 5);
  ASSERT_TRUE(found.symmetry);
  EXPECT_THAT(found.symmetry->alike, ElementsAre(ElementsAre("left", "right")));
  std::vector<double> by_member(3);
  for (const Place& p : found.kinds[0].places)
    by_member[static_cast<std::size_t>(p.stretch)] += p.expected;
  EXPECT_GT(by_member[0], 0.3);
  for (const auto& chain : found.symmetry->chains)
    EXPECT_NEAR(chain.left, chain.right, 5.0 * chain.mcse_of_difference + 0.01);
  EXPECT_NEAR(by_member[0], by_member[2], 0.1);
  EXPECT_TRUE(std::ranges::any_of(found.remarks, [](const Remark& r) {
    return std::holds_alternative<remark::StructureImages>(r);
  }));
}

}  // namespace
}  // namespace wheeltap::identification
