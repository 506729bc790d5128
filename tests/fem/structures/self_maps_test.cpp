#include "fem/structures/self_maps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wheeltap::fem {
namespace {

Structure of(const std::vector<Vector3>& nodes, const std::vector<std::array<int, 2>>& members) {
  Structure s;
  for (const Vector3& at : nodes) s.nodes.push_back({"", at});
  for (const auto& ends : members) s.members.push_back({.name = "", .nodes = ends});
  return s;
}

/// The maps and the identity form a group, and each maps members to members.
void expect_group(const Structure& s, std::size_t order) {
  std::vector<SelfMap> maps = self_maps(s);
  EXPECT_EQ(maps.size() + 1, order);
  std::vector<std::vector<int>> nodes;
  for (const SelfMap& map : maps) nodes.push_back(map.node);
  std::vector<int> identity;
  for (int i = 0; i < static_cast<int>(s.nodes.size()); ++i) identity.push_back(i);
  nodes.push_back(identity);
  for (const auto& a : nodes)
    for (const auto& b : nodes) {
      std::vector<int> both;
      for (const int i : a) both.push_back(b[static_cast<std::size_t>(i)]);
      EXPECT_EQ(std::ranges::count(nodes, both), 1);
    }
  for (const SelfMap& map : maps)
    for (std::size_t m = 0; m < s.members.size(); ++m) {
      const auto& from = s.members[m].nodes;
      const auto& to = s.members[static_cast<std::size_t>(map.member[m])].nodes;
      for (std::size_t end = 0; end < 2; ++end)
        EXPECT_EQ(map.node[static_cast<std::size_t>(from[end])],
                  to[map.reversed[m] ? 1 - end : end]);
    }
}

TEST(SelfMaps, FindsSymmetriesOfPlaneFrames) {
  expect_group(of({{0, 0, 0}, {0, 3, 0}, {5, 3, 0}, {5, 0, 0}}, {{0, 1}, {1, 2}, {3, 2}}), 2);
  expect_group(of({{0, 0, 0}, {0, 3, 0}, {5, 3, 0}}, {{0, 1}, {1, 2}}), 1);
  expect_group(of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}),
               8);
  // The square without one side is symmetric under one reflection.
  expect_group(of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1}, {1, 2}, {2, 3}}), 2);
  expect_group(of({{0, 0, 0}, {7, 0, 0}, {14, 0, 0}}, {{0, 1}, {1, 2}}), 2);  // on a line
}

TEST(SelfMaps, FindsSymmetriesOfRadialArms) {
  std::vector<Vector3> nodes = {{0, 0, 0}};
  std::vector<std::array<int, 2>> members;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::numbers::pi / 4;
    nodes.push_back({5 * std::cos(angle), 5 * std::sin(angle), 0});
    members.push_back({0, i + 1});
  }
  expect_group(of(nodes, members), 16);
  nodes[3][1] *= 1.001;
  expect_group(of(nodes, members), 2);
}

TEST(SelfMaps, FindsSymmetriesOfACube) {
  std::vector<Vector3> nodes;
  std::vector<std::array<int, 2>> members;
  for (int i = 0; i < 8; ++i)
    nodes.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if (!(i & bit)) members.push_back({i, i | bit});
  expect_group(of(nodes, members), 48);
}

TEST(SelfMaps, FindsSymmetriesOfChains) {
  const LumpedChain fixed{
      .masses = {1, 2, 1},
      .links = {{"a", {0, 1}, 1.0}, {"b", {1, 2}, 1.0}, {"c", {2, 3}, 1.0}, {"d", {3, 0}, 1.0}}};
  ASSERT_EQ(self_maps(fixed).size(), 1U);
  EXPECT_EQ(self_maps(fixed)[0].member, (std::vector{3, 2, 1, 0}));
  const LumpedChain building{.masses = {1, 1}, .links = {{"a", {0, 1}, 1.0}, {"b", {1, 2}, 1.0}}};
  EXPECT_TRUE(self_maps(building).empty());
}

}  // namespace
}  // namespace wheeltap::fem
