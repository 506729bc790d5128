#include "apps/cases/structures/structure_case.hpp"

#include <cmath>
#include <numbers>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/structures/structure_section.hpp"
#include "fem/sections/section.hpp"
#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps::structure_case_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

/// The portal frame with one value changed or removed.
json changed(const std::string& pointer, const json& value, json base = portal_frame()) {
  base[json::json_pointer(pointer)] = value;
  return base;
}
json without(const std::string& pointer, json base = portal_frame()) {
  const json::json_pointer at(pointer);
  base[at.parent_pointer()].erase(at.back());
  return base;
}

TEST(StructureCase, PortalFrameIsReadAsItStands) {
  const auto model = parsed(portal_frame());
  ASSERT_EQ(model.parameters.size(), 1U);
  EXPECT_EQ(model.parameters[0].name, "E");
  const auto& s = std::get<fem::Structure>(model.nominal);
  EXPECT_EQ(s.dimension, 2);
  ASSERT_EQ(s.members.size(), 3U);
  const fem::Member& beam = s.members[1];
  EXPECT_EQ(beam.name, "beam");
  EXPECT_EQ(s.nodes[static_cast<std::size_t>(beam.nodes[1])].name, "C");
  EXPECT_EQ(beam.ends[0].rotation[1], 1e4);
  EXPECT_EQ(beam.ends[1].rotation[1], 0.0);
  EXPECT_TRUE(std::isinf(beam.ends[0].rotation[0]));
  EXPECT_EQ(s.members[2].axial_force, -100.0);
  EXPECT_NEAR(beam.pieces[0].material.young, std::exp(26.07), 1e-6 * std::exp(26.07));
  EXPECT_EQ(beam.pieces[0].section.depth, 0.01);
  EXPECT_DOUBLE_EQ(beam.pieces[0].section.second_moment_y, 0.05 * 1e-6 / 12.0);
  EXPECT_DOUBLE_EQ(beam.pieces[0].section.shear_coefficient_z, fem::cowper_rectangle(0.3));
  EXPECT_THAT(s.supports[0].fix, ElementsAre(true, true, false, false, false, true));
  EXPECT_EQ(s.supports[1].stiffness[5], 1e4);
  EXPECT_EQ(s.masses[0].mass, 2.0);
  EXPECT_EQ(s.springs[0].direction, fem::NodeSpring::kAlong);
}

TEST(StructureCase, AParameterStandsWhereItsNameStands) {
  // Frequencies that depend on E only are proportional to its root.
  json base = portal_frame();
  for (const char* key : {"springs", "supports"}) base["structure"].erase(key);
  base["structure"]["supports"] = {{{"node", "A"}, {"fix", {"x", "y", "rotation"}}}};
  base["structure"]["members"][1].erase("ends");
  base["structure"]["members"][2].erase("axial_force");
  const auto model = parsed(base);
  const double e = std::exp(26.07);
  const auto one = frequencies(model.at(std::vector{e}), 3);
  const auto four = frequencies(model.at(std::vector{4.0 * e}), 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(four[i] / one[i], 2.0, 1e-9);
}

/// Every coefficient of members, supports, masses and springs.
TEST(StructureCase, EveryCoefficientMayBeAParameter) {
  const std::vector<std::pair<std::string, double>> places = {
      {"/structure/materials/steel/young", 2e11},
      {"/structure/materials/steel/poisson", 0.25},
      {"/structure/materials/steel/density", 7000.0},
      {"/structure/sections/post/width", 0.06},
      {"/structure/sections/post/height", 0.012},
      {"/structure/sections/post/shear_coefficient", 0.8},
      {"/structure/members/1/ends/B/rotation", 2e4},
      {"/structure/members/2/axial_force", 50.0},
      {"/structure/members/0/foundation", 300.0},
      {"/structure/supports/1/stiffness/rotation", 300.0},
      {"/structure/masses/0/mass", 1.0},
      {"/structure/masses/0/inertia", 0.1},
      {"/structure/springs/0/stiffness", 1e4}};
  const json base = changed("/structure/materials/steel/young", 2.1e11, without("/parameters"));
  for (const auto& [pointer, value] : places) {
    json unknown = changed(pointer, "p", base);
    // Its nominal value is half of the set value.
    unknown["parameters"]["p"] = {
        {"truncated_normal",
         {0.5 * value, 1e-3 * value, 0.1 * value, 0.49 * std::max(value, 1.0) * 4}}};
    if (pointer.ends_with("poisson")) unknown["parameters"]["p"] = {{"uniform", {0.0, 0.49}}};
    const auto model = parsed(unknown);
    expect_near(frequencies(model.at(std::vector{value}), 6),
                frequencies(members_of(changed(pointer, value, base)), 6), 1e-10);
    EXPECT_NE(frequencies(model.nominal, 12), frequencies(model.at(std::vector{value}), 12))
        << pointer;
  }
}

TEST(StructureCase, SectionsOfSeveralParametersFollowThemAll) {
  json both = changed("/structure/materials/steel/young", 2.1e11);
  both["structure"]["sections"]["post"] = {{"shape", "rectangle"}, {"width", "b"}, {"height", "h"}};
  both["parameters"] = {{"b", {{"uniform", {0.01, 0.1}}}}, {"h", {{"uniform", {0.001, 0.1}}}}};
  const auto model = parsed(both);
  const auto s = std::get<fem::Structure>(model.at(std::vector{0.03, 0.02}));
  for (const auto& member : s.members) {
    EXPECT_DOUBLE_EQ(member.pieces[0].section.area, 0.03 * 0.02);
    EXPECT_DOUBLE_EQ(member.pieces[0].section.second_moment_y, 0.03 * 8e-6 / 12.0);
    EXPECT_DOUBLE_EQ(member.pieces[0].section.depth, 0.02);
  }
}

// ---- members

TEST(StructureCase, PiecesOffsetsAndHinges) {
  json two = portal_frame();
  two["structure"]["materials"]["lead"] = {{"young", 16e9}, {"poisson", 0.44}, {"density", 11340}};
  two["structure"]["sections"]["thick"] = {
      {"shape", "rectangle"}, {"width", 0.05}, {"height", 0.02}};
  two["structure"]["members"][0]["pieces"] = {
      {{"to", 0.3}}, {{"to", 0.7}, {"material", "lead"}}, {{"section", "thick"}}};
  two["structure"]["members"][1]["offsets"] = {{"B", {0.1, 0.05}}, {"C", {-0.1, 0.05}}};
  const fem::Structure s = members_of(two);
  const auto& pieces = s.members[0].pieces;
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_EQ(pieces[0].to, 0.3);
  EXPECT_EQ(pieces[1].material.density, 11340.0);
  EXPECT_EQ(pieces[1].section.depth, 0.01);
  EXPECT_EQ(pieces[2].to, 1.0);
  EXPECT_EQ(pieces[2].material.density, 7850.0);
  EXPECT_EQ(pieces[2].section.depth, 0.02);
  EXPECT_THAT(s.members[1].ends[1].offset, ElementsAre(-0.1, 0.05, 0.0));
  EXPECT_NEAR(s.members[1].pieces[0].to, 0.8, 1e-12);
}

TEST(StructureCase, EndsInSpaceTurnAboutTheMembersAxes) {
  json arm = cantilever_in_space();
  arm["structure"]["members"][0]["ends"] = {{"A", {{"rx", 5.0}, {"rz", 7.0}}}, {"B", "hinge"}};
  arm["structure"]["members"][0]["up"] = {0, 1, 0};
  const fem::Member member = members_of(arm).members[0];
  EXPECT_EQ(member.ends[0].rotation[0], 5.0);
  EXPECT_TRUE(std::isinf(member.ends[0].rotation[1]));
  EXPECT_EQ(member.ends[0].rotation[2], 7.0);
  EXPECT_TRUE(std::isinf(member.ends[1].rotation[0])) << "a hinge transmits torsion";
  EXPECT_EQ(member.ends[1].rotation[1], 0.0);
  EXPECT_EQ(member.ends[1].rotation[2], 0.0);
  EXPECT_THAT(member.up, ElementsAre(0.0, 1.0, 0.0));
}

TEST(StructureCase, MassOfMembers) {
  EXPECT_EQ(members_of(portal_frame()).mass, fem::Structure::Mass::consistent);
  EXPECT_EQ(members_of(changed("/structure/mass", "lumped")).mass, fem::Structure::Mass::lumped);
  EXPECT_FALSE(members_of(changed("/structure/rotary_inertia", false)).rotary_inertia);
  expect_refused(changed("/structure/mass", "heavy"), "/structure/mass: \"heavy\": must be");
}

TEST(StructureCase, MassesAndSpringsInSpace) {
  json arm = cantilever_in_space();
  arm["structure"]["masses"] = {{{"node", "B"}, {"mass", 1.0}, {"inertia", {1.0, 2.0, 3.0}}},
                                {{"node", "B"}, {"inertia", 4.0}}};
  arm["structure"]["springs"] = {{{"node", "B"}, {"direction", "ry"}, {"stiffness", 9.0}},
                                 {{"nodes", {"A", "B"}}, {"direction", "z"}, {"stiffness", 8.0}}};
  arm["structure"]["dashpots"] = {{{"node", "B"}, {"direction", "x"}, {"damping", 3.0}}};
  const fem::Structure s = members_of(arm);
  EXPECT_THAT(s.masses[0].inertia, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(s.masses[1].inertia, ElementsAre(4.0, 4.0, 4.0));
  EXPECT_EQ(s.springs[0].nodes[1], fem::NodeSpring::kGround);
  EXPECT_EQ(s.springs[0].direction, static_cast<int>(fem::Direction::ry));
  EXPECT_EQ(s.springs[1].direction, static_cast<int>(fem::Direction::z));
  EXPECT_EQ(members_of(changed("/structure/masses/0/inertia", 0.5)).masses[0].inertia[2], 0.5);
}

// ---- sections

fem::MemberSection section_in_space(const json& section) {
  json arm = cantilever_in_space();
  arm["structure"]["sections"]["bar"] = section;
  return members_of(arm).members[0].pieces[0].section;
}

TEST(StructureSection, ShapesInSpace) {
  const double pi = std::numbers::pi;
  const auto r = section_in_space({{"shape", "rectangle"}, {"width", 0.02}, {"height", 0.05}});
  EXPECT_DOUBLE_EQ(r.second_moment_y, 0.02 * std::pow(0.05, 3) / 12);
  EXPECT_DOUBLE_EQ(r.second_moment_z, 0.05 * std::pow(0.02, 3) / 12);
  EXPECT_EQ(r.torsion_constant, fem::rectangle_torsion_constant(0.02, 0.05));
  const auto c = section_in_space({{"shape", "circle"}, {"diameter", 0.1}});
  EXPECT_DOUBLE_EQ(c.torsion_constant, pi * 1e-4 / 32);
  EXPECT_DOUBLE_EQ(c.shear_coefficient_y, fem::cowper_circle(0.3));
  const auto t =
      section_in_space({{"shape", "tube"}, {"outer_diameter", 0.1}, {"thickness", 0.01}});
  EXPECT_NEAR(t.torsion_constant, pi / 32 * (1e-4 - std::pow(0.08, 4)), 1e-18);
  const auto a = section_in_space({{"area", 1.0},
                                   {"second_moments", {{"yy", 2.0}, {"zz", 3.0}}},
                                   {"torsion_constant", 4.0},
                                   {"shear_coefficient", {{"y", 0.5}, {"z", "none"}}},
                                   {"depth", 6.0}});
  EXPECT_EQ(a.second_moment_y, 2.0);
  EXPECT_EQ(a.second_moment_z, 3.0);
  EXPECT_EQ(a.torsion_constant, 4.0);
  EXPECT_EQ(a.shear_coefficient_y, 0.5);
  EXPECT_TRUE(std::isinf(a.shear_coefficient_z));
  EXPECT_EQ(a.depth, 6.0);
}

#ifdef WHEELTAP_WITH_CGAL
TEST(StructureSection, WhatHasNoFormulaIsMeshed) {
  const json outline = {{-0.05, -0.1}, {0.05, -0.1}, {0.05, 0.1}, {-0.05, 0.1}};
  const auto p = section_in_space({{"shape", "polygon"}, {"outline", outline}});
  EXPECT_NEAR(p.torsion_constant / fem::rectangle_torsion_constant(0.1, 0.2), 1.0, 1e-4);
  EXPECT_NEAR(p.shear_coefficient_z, 1 / 1.20056, 1e-4);
  EXPECT_NEAR(p.shear_coefficient_y, 1 / 1.27479, 1e-3);
  EXPECT_NEAR(p.depth, 0.2, 1e-12);
  const json i = {{"shape", "i"},
                  {"height", 0.2},
                  {"width", 0.1},
                  {"flange_thickness", 0.01},
                  {"web_thickness", 0.006}};
  const auto s = section_in_space(i);
  EXPECT_NEAR(s.second_moment_z, (2 * 0.01 * 1e-3 + 0.18 * std::pow(0.006, 3)) / 12, 1e-15);
  // Thin walls: slightly more than Σ b t³ / 3.
  const double thin = (2 * 0.1 * 1e-6 + 0.19 * std::pow(0.006, 3)) / 3;
  EXPECT_GT(s.torsion_constant, 0.95 * thin);
  EXPECT_LT(s.torsion_constant, 1.2 * thin);
  // Bredt: 4 A² / Σ(l/t) of a thin box, to the relative thickness of its walls.
  const auto b = section_in_space({{"shape", "box"},
                                   {"height", 0.2},
                                   {"width", 0.1},
                                   {"flange_thickness", 0.004},
                                   {"web_thickness", 0.004}});
  const double area = 0.196 * 0.096;
  EXPECT_NEAR(b.torsion_constant / (4 * area * area * 0.004 / (2 * 0.292)), 1.0, 0.02);
  // Two materials: mass from densities, stiffness from moduli.
  json two = cantilever_in_space();
  two["structure"]["sections"]["bar"] = {
      {"shape", "polygon"},
      {"outline", {{-0.05, -0.1}, {0.05, -0.1}, {0.05, 0}, {-0.05, 0}}},
      {"regions",
       {{{"outline", {{-0.05, 0}, {0.05, 0}, {0.05, 0.1}, {-0.05, 0.1}}},
         {"modulus", 1.0},
         {"density", 3 * 7850}}}}};
  const auto piece = members_of(two).members[0].pieces[0];
  EXPECT_NEAR(piece.material.density * piece.section.area, 0.01 * (1 + 3) * 7850, 1e-6);
}

TEST(StructureSection, AxesThatAreNotPrincipalAreRefusedInSpaceOnly) {
  const json l = {
      {"shape", "polygon"},
      {"outline", {{0, 0}, {0.1, 0}, {0.1, 0.02}, {0.02, 0.02}, {0.02, 0.2}, {0, 0.2}}}};
  json arm = cantilever_in_space();
  arm["structure"]["sections"]["bar"] = l;
  expect_refused(arm, "/structure/sections/bar: the axes y and z of the section are not principal");
  EXPECT_NO_THROW((void)parsed(changed("/structure/sections/post", l)));
}

TEST(StructureSection, AShearCentreAwayFromTheCentroidIsSaid) {
  json arm = cantilever_in_space();
  arm["structure"]["sections"]["bar"] = {{"shape", "polygon"},
                                         {"outline",
                                          {{0, 0},
                                           {0.085, 0},
                                           {0.085, 0.01},
                                           {0.01, 0.01},
                                           {0.01, 0.18},
                                           {0.085, 0.18},
                                           {0.085, 0.19},
                                           {0, 0.19}}}};
  std::vector<std::string> remarks;
  (void)parsed(arm, &remarks);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0], HasSubstr("the shear centre of section bar is"));
}

TEST(StructureSection, MeshedSectionsNeedNumbers) {
  const json outline = {{-0.05, -0.1}, {0.05, -0.1}, {0.05, 0.1}, {-0.05, 0.1}};
  json unknown = changed("/structure/sections/post", {{"shape", "polygon"}, {"outline", outline}});
  unknown["parameters"]["nu"] = {{"uniform", {0.1, 0.4}}};
  unknown["structure"]["materials"]["steel"]["poisson"] = "nu";
  expect_refused(unknown, "poisson of its material must be a number");
  unknown["structure"]["sections"]["post"]["shear_coefficient"] = 0.83;
  EXPECT_NO_THROW((void)parsed(unknown)) << "nothing else depends on it, and E may be unknown";
}
#endif

TEST(StructureSection, Refusals) {
  const std::string post = "/structure/sections/post";
  expect_refused(without(post + "/height"),
                 post + "/height: is missing: a \"rectangle\" section has width, height");
  expect_refused(changed(post + "/diameter", 1),
                 post + "/diameter: 1: is not a dimension of a \"rectangle\" section");
  expect_refused(changed(post + "/width", -1), post + "/width: -1: must be > 0");
  expect_refused(changed(post, {{"shape", "tube"}, {"outer_diameter", 0.1}, {"thickness", 0.06}}),
                 post);
  expect_refused(changed(post, {{"area", 1}, {"shear_coefficient", 1}}), post + "/second_moment");
  expect_refused(changed(post, {{"area", 1}, {"second_moment", 1}}),
                 post + "/shear_coefficient: is missing");
  expect_refused(changed(post + "/shear_coefficient", {{"y", 1}}), "has shear along z only");
  expect_refused(
      changed(post, {{"shape", "polygon"}, {"outline", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}}}),
      post + "/outline");
  json arm = cantilever_in_space();
  arm["structure"]["sections"]["bar"] = {
      {"area", 1}, {"second_moment", 1}, {"shear_coefficient", 1}};
  expect_refused(arm, "/structure/sections/bar/second_moment: 1: in a three-dimensional structure");
  arm["structure"]["sections"]["bar"] = {
      {"area", 1}, {"second_moments", {{"yy", 1}, {"zz", 1}}}, {"shear_coefficient", 1}};
  expect_refused(arm, "/structure/sections/bar/torsion_constant: is missing");
}

// ---- invalid cases, with the place in the message

TEST(StructureCase, RefusesWhatIsWrongInANodeOrAMember) {
  expect_refused(changed("/structure/nodes/A", {0, 0, 0}),
                 "/structure/nodes/A: [0,0,0]: must be [x, y]");
  expect_refused(changed("/structure/nodes/B", {0, 0}),
                 "/structure/members/0: member \"left post\": its ends at A and B coincide");
  expect_refused(changed("/structure/members/0/nodes", {"A", "A"}),
                 "/structure/members/0/nodes: [\"A\",\"A\"]: are the same node");
  expect_refused(changed("/structure/members/0/nodes/1", "X"),
                 "/structure/members/0/nodes/1: \"X\": no node has this name");
  expect_refused(changed("/structure/members/1/name", "left post"),
                 "/structure/members/1/name: \"left post\": two members have this name");
  expect_refused(changed("/structure/members/1/elements", 0),
                 "/structure/members/1/elements: 0: must be >= 1");
  expect_refused(without("/structure/members/1/elements"),
                 "/structure/members/1/elements: is missing");
  expect_refused(
      changed("/structure/members/1/section", "pots"),
      "/structure/members/1/section: \"pots\": no section has this name; did you mean \"post\"?");
  expect_refused(without("/structure/members/1/material"),
                 "/structure/members/1/material: is missing");
  expect_refused(changed("/structure/members/1/ends/D", "hinge"),
                 "/structure/members/1/ends/D: \"hinge\": is not an end node of this member");
  expect_refused(changed("/structure/members/1/ends/B", {{"rx", 1}}),
                 "in a plane structure, the only key of an end is \"rotation\"");
  expect_refused(changed("/structure/members/1/ends/B/rotation", -1),
                 "/structure/members/1/ends/B/rotation: -1");
  expect_refused(changed("/structure/members/1/offsets", {{"B", {0, 0, 1}}}),
                 "/structure/members/1/offsets/B");
  expect_refused(changed("/structure/members/1/up", {0, 0, 1}),
                 "/structure/members/1/up: [0,0,1]: is allowed with dimension 3");
  expect_refused(changed("/structure/members/1/pieces", {{{"to", 0.5}}, {{"to", 0.4}}}),
                 "/structure/members/1/pieces/1/to: 0.4: must be greater than");
  expect_refused(changed("/structure/members/1/pieces", {{{"to", 0.5}}}),
                 "/structure/members/1/pieces/0/to: 0.5: the last segment must end at the member's "
                 "length, 1 m");
  expect_refused(changed("/structure/members/1/pieces", {json::object(), {{"to", 1}}}),
                 "/structure/members/1/pieces/0/to: is missing");
  expect_refused(changed("/structure/members/1/wdith", 1),
                 "/structure/members/1/wdith: 1: unknown key");
  json arm = cantilever_in_space();
  arm["structure"]["members"][0]["up"] = {1, 0, 0};
  expect_refused(arm, "/structure/members/0: member \"arm\": \"up\" is parallel to the member");
}

TEST(StructureCase, RefusesWhatIsWrongAtANode) {
  expect_refused(changed("/structure/supports/0/node", "E"),
                 "/structure/supports/0/node: \"E\": no node has this name");
  expect_refused(changed("/structure/supports/0/fix", {"z"}),
                 "/structure/supports/0/fix/0: \"z\": unknown direction");
  expect_refused(changed("/structure/supports/0/stiffness", {{"x", 1}}),
                 "/structure/supports/0/stiffness/x: 1: is fixed already");
  expect_refused(changed("/structure/supports/0", {{"node", "A"}}),
                 "/structure/supports/0/fix: is missing");
  expect_refused(changed("/structure/masses/0/mass", -2),
                 "/structure/masses/0/mass: -2: must be >= 0");
  expect_refused(changed("/structure/masses/0/inertia", {1, 1, 1}),
                 "/structure/masses/0/inertia: [1,1,1]: in a plane structure");
  expect_refused(changed("/structure/springs/0", {{"node", "B"}, {"stiffness", 1}}),
                 "/structure/springs/0/direction: is missing");
  expect_refused(changed("/structure/springs/0", {{"stiffness", 1}}),
                 "/structure/springs/0: must have \"nodes\"");
  expect_refused(changed("/structure/springs/0/nodes", {"B", "B"}), "/structure/springs/0/nodes");
  expect_refused(changed("/structure/dashpots", {{{"nodes", {"B", "Q"}}, {"damping", 1}}}),
                 "/structure/dashpots/0/nodes/1: \"Q\"");
}

TEST(StructureCase, RefusesParametersThatAreNone) {
  expect_refused(changed("/parameters/k", {{"uniform", {0, 1}}}),
                 "/parameters/k: no coefficient of the structure has this name");
  expect_refused(without("/parameters"),
                 "/structure/materials/steel/young: \"E\": no parameter has this name");
  expect_refused(changed("/parameters/E", {{"normal", {2e11, 1e10}}}),
                 "/parameters/E: reaches down to");
  expect_refused(changed("/parameters/E", {{"uniform", {2, 1}}}), "/parameters/E/uniform");
}

TEST(StructureCase, RefusesMixedAndMissingKinds) {
  expect_refused({{"kind", "damage"}, {"structure", json::object()}},
                 "/structure: must have \"nodes\"");
  const json link = {{"between", {0, 1}}, {"stiffness", 1e5}};
  expect_refused(changed("/structure/chain", {{"masses", {1}}, {"links", {link}}}),
                 "is not allowed with \"chain\"");
  expect_refused(changed("/structure/dofs", "d.csv"),
                 "/structure/dofs: \"d.csv\": is not allowed with \"nodes\"");
  json both = portal_frame();
  both["beam"] = json::object();
  const CaseFile file{.path = "case.json", .json = both};
  EXPECT_THROW((void)has_structure(file), Failure);
  EXPECT_THROW((void)parse_damage_case(file), Failure);
}

TEST(StructureCase, AMillionElementsAreRefusedWithTheirCost) {
  expect_refused(changed("/structure/members/1/elements", 1'000'000),
                 "/structure/members/1/elements: 1000000: the structure would have 3000051 degrees "
                 "of freedom and take about");
}

// ---- chains

TEST(StructureCase, Chains) {
  json c = chain({6.0, 6.0}, {1e5, 2e5});
  c["structure"]["chain"]["links"][0]["stiffness"] = "k";
  c["structure"]["chain"]["links"][0]["name"] = "storey 1";
  c["parameters"]["k"] = {{"log_normal", {std::log(1e5), 0.1}}};
  const auto model = parsed(c);
  const auto& s = std::get<fem::LumpedChain>(model.nominal);
  EXPECT_EQ(s.links[0].name, "storey 1");
  EXPECT_EQ(s.links[1].name, "link 2");
  EXPECT_NEAR(s.links[0].stiffness, 1e5, 1e-6);
  EXPECT_EQ(std::get<fem::LumpedChain>(model.at(std::vector{3e5})).links[0].stiffness, 3e5);
  const json good = chain({6.0, 6.0}, {1e5, 2e5});
  const std::string links = "/structure/chain/links";
  expect_refused(changed(links + "/1/between", {1, 3}, good),
                 links + "/1/between/1: 3: unknown mass");
  expect_refused(changed(links + "/1/between", {1, 1}, good),
                 links + "/1/between: [1,1]: must join two different masses");
  expect_refused(changed("/structure/chain/masses/0", 0, good),
                 "/structure/chain/masses/0: 0: must be > 0");
  expect_refused(changed(links + "/1/stiffness", -1, good), links + "/1/stiffness: -1");
}

}  // namespace
}  // namespace wheeltap::apps::structure_case_test
