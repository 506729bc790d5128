#include "identification/structural/structure_plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/identification/cases.hpp"

namespace wheeltap::identification {
namespace {

template <class R>
const R* find_remark(const std::vector<Remark>& remarks) {
  for (const Remark& remark : remarks)
    if (const R* found = std::get_if<R>(&remark)) return found;
  return nullptr;
}

constexpr fem::Material kSteel = {.young = 2.1e11, .poisson = 0.3, .density = 7850.0};

// Nodes at the corners of a square of 1 m, and members between them.
fem::Structure square_frame(const std::vector<std::array<int, 2>>& members) {
  fem::Structure out{.dimension = 2, .nodes = {}, .members = {}};
  const std::array<fem::Vector3, 4> corners = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  const std::array<const char*, 4> names = {"A", "B", "C", "D"};
  for (std::size_t i = 0; i < 4; ++i) out.nodes.push_back({.name = names[i], .at = corners[i]});
  for (const auto& nodes : members)
    out.members.push_back(
        {.name = std::string(names[static_cast<std::size_t>(nodes[0])]) +
                 names[static_cast<std::size_t>(nodes[1])],
         .nodes = nodes,
         .pieces = {
             {.to = 1.0, .material = kSteel, .section = {.area = 1e-4, .second_moment_y = 1e-9}}}});
  return out;
}

TEST(StructurePlausibility, ReportsAYoungsModulusInGigapascals) {
  using Property = remark::ImplausibleMaterial::Property;
  const auto odd = implausible_material("the beam", 210.0, 7850.0);
  ASSERT_TRUE(odd);
  EXPECT_EQ(odd->property, Property::young);
  EXPECT_EQ(odd->unit, "GPa");
  EXPECT_DOUBLE_EQ(odd->converted, 2.1e11);
  EXPECT_EQ(implausible_material("", 210e3, 7850.0)->unit, "MPa (N/mm²)");
  EXPECT_EQ(implausible_material("", 2.1e8, 7850.0)->unit, "kPa");
  const auto light = implausible_material("", 2.1e11, 7.85);
  ASSERT_TRUE(light);
  EXPECT_EQ(light->property, Property::density);
  EXPECT_DOUBLE_EQ(light->converted, 7850.0);
  EXPECT_EQ(implausible_material("", 2.1e11, 7.85e-9)->unit, "t/mm³");
  // A weight in kN/m³ used as a density is detected only by the speed of sound.
  EXPECT_EQ(implausible_material("", 2.1e11, 78.5)->property, Property::speed_of_sound);
  for (const auto& [young, density] : {std::pair{2.1e11, 7850.0},
                                       {7e10, 2700.0},
                                       {1e10, 450.0},
                                       {3e10, 2400.0},
                                       {3e9, 0.0},
                                       {1e15, 0.0},
                                       {2e11, 50000.0 / 2.5}})
    EXPECT_FALSE(implausible_material("", young, density)) << young << " " << density;
}

TEST(StructurePlausibility, ReportsABeamInMillimetres) {
  fem::Beam beam = small_beam(1).beam;
  EXPECT_TRUE(implausible(beam).empty());
  beam.section = fem::section(fem::Rectangle{.width = 25.0, .height = 6.0}, 0.3);
  const auto* deep = find_remark<remark::DeepSection>(implausible(beam));
  EXPECT_NE(deep, nullptr);
  beam.material.young = 70.0;
  EXPECT_NE(find_remark<remark::ImplausibleMaterial>(implausible(beam)), nullptr);
}

TEST(StructurePlausibility, ReportsTwinMembersAndUnusedNodes) {
  EXPECT_TRUE(implausible(AnyStructure(square_frame({{0, 1}, {1, 2}, {2, 3}, {3, 0}}))).empty());
  const auto remarks = implausible(AnyStructure(square_frame({{0, 1}, {1, 2}, {1, 0}})));
  const auto* twins = find_remark<remark::TwinMembers>(remarks);
  ASSERT_NE(twins, nullptr);
  EXPECT_EQ(twins->first, "AB");
  EXPECT_EQ(twins->second, "BA");
  const auto* unused = find_remark<remark::UnusedNodes>(remarks);
  ASSERT_NE(unused, nullptr);
  EXPECT_EQ(unused->nodes, std::vector<std::string>{"D"});
}

TEST(StructurePlausibility, ReportsMembersThatCrossWithoutAJoint) {
  fem::Structure crossed = square_frame({{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}});
  const auto remarks = implausible(AnyStructure(crossed));
  const auto* found = find_remark<remark::CrossingMembers>(remarks);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->count, 1);
  EXPECT_NEAR(found->pairs[0].at[0], 0.5, 1e-12);
  EXPECT_TRUE(found->pairs[0].between);
  // A member that ends on another between its nodes.
  fem::Structure tee = square_frame({{0, 1}, {2, 3}, {1, 2}, {3, 0}});
  tee.nodes.push_back({.name = "M", .at = {0.5, 0, 0}});
  tee.members.push_back(tee.members[0]);
  tee.members.back().name = "MC";
  tee.members.back().nodes = {4, 2};
  const auto touching = implausible(AnyStructure(tee));
  ASSERT_NE(find_remark<remark::CrossingMembers>(touching), nullptr);
  EXPECT_EQ(find_remark<remark::CrossingMembers>(touching)->count, 1);
  // Members that pass each other in space do not cross.
  crossed.dimension = 3;
  crossed.nodes[3].at[2] = 0.1;
  EXPECT_EQ(find_remark<remark::CrossingMembers>(implausible(AnyStructure(crossed))), nullptr);
}

TEST(StructurePlausibility, ReportsSensorsAtOnePlace) {
  const std::vector<Remark> remarks =
      implausible(std::vector<Sensor>{{"B, x", {}}, {"C, x", {}}, {"B, x", {}}});
  const auto* same = find_remark<remark::SensorsAtOnePlace>(remarks);
  ASSERT_NE(same, nullptr);
  EXPECT_EQ(same->pairs.at(0).first, 1);
  EXPECT_EQ(same->pairs.at(0).second, 3);
}

}  // namespace
}  // namespace wheeltap::identification
