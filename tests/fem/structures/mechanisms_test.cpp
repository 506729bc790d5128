#include "fem/structures/mechanisms.hpp"

#include <gmock/gmock.h>

#include "base/eigen_solvers.hpp"
#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/matrix_structure.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::fem {
namespace {

using testing::HasSubstr;

/// n1 to n3 along x, pinned at both ends, with `hinges` at n2 and `elements` per member.
Structure two_spans(bool hinge, int elements) {
  const Material steel{.young = 200e9, .poisson = 0.3, .density = 7850.0};
  const MemberSection section{.area = 6e-3, .second_moment_y = 7e-5};
  Structure s{.dimension = 2,
              .nodes = {{"n1", {0, 0, 0}}, {"n2", {1, 0, 0}}, {"n3", {2, 0, 0}}},
              .members = {}};
  for (int i = 0; i < 2; ++i)
    s.members.push_back({.name = "m" + std::to_string(i + 1),
                         .nodes = {i, i + 1},
                         .elements = elements,
                         .pieces = {{.to = 1.0, .material = steel, .section = section}}});
  if (hinge) s.members[1].ends[0].rotation.fill(0.0);
  s.supports = {{.node = 0, .fix = {true, true}}, {.node = 2, .fix = {false, true}}};
  return s;
}

std::string refusal_of(const Discretisation& d) {
  try {
    static_cast<void>(structure_modes(d, 2));
  } catch (const InvalidStructure& error) {
    return error.what();
  }
  return "none";
}

TEST(Mechanisms, NamesAHingeAtMidspan) {
  for (const int elements : {1, 8, 200}) {
    const Discretisation d = Mesh(two_spans(true, elements)).discretisation();
    ASSERT_EQ(mechanisms(d).size(), 1U) << elements;
    EXPECT_THAT(refusal_of(d), HasSubstr("nothing resists a motion that is largest at n2, y"));
    EXPECT_TRUE(mechanisms(Mesh(two_spans(false, elements)).discretisation()).empty());
  }
}

TEST(Mechanisms, NamesEachOfSeveralMechanisms) {
  Structure s = two_spans(true, 4);
  s.nodes.push_back({"n4", {3, 0, 0}});
  s.nodes.push_back({"n5", {4, 0, 0}});
  for (const int i : {2, 3}) {
    Member m = s.members[1];
    m.name = "m" + std::to_string(i + 1);
    m.nodes = {i, i + 1};
    s.members.push_back(m);
  }
  s.supports[1].node = 4;
  const Discretisation d = Mesh(s).discretisation();
  EXPECT_EQ(mechanisms(d).size(), 3U);
  const std::string said = refusal_of(d);
  EXPECT_THAT(said, HasSubstr("nothing resists 3 motions"));
  for (const char* node : {"n2, y", "n3, y", "n4, y"}) EXPECT_THAT(said, HasSubstr(node));
}

// A free structure is not a mechanism; neither are stiff and soft parts.
TEST(Mechanisms, ExcludesRigidMotionsAndSoftParts) {
  Structure floating = two_spans(false, 8);
  floating.supports.clear();
  EXPECT_TRUE(mechanisms(Mesh(floating).discretisation()).empty());
  const LumpedChain chain{.masses = {1.0, 1.0, 1.0},
                          .links = {{.name = "a", .between = {0, 1}, .stiffness = 1e9},
                                    {.name = "b", .between = {1, 2}, .stiffness = 1e-3}}};
  EXPECT_TRUE(mechanisms(discretise(chain)).empty());
}

TEST(Mechanisms, MatricesNameTheirDegreesOfFreedom) {
  Eigen::Matrix3d k;
  k << 2.0, -2.0, 0.0, -2.0, 2.0, 0.0, 0.0, 0.0, 5.0;
  MatrixStructure s{.mass = Discretisation::Sparse(Eigen::Matrix3d::Identity().sparseView()),
                    .parts = {{.name = "K", .stiffness = k.sparseView()}}};
  EXPECT_THAT(refusal_of(discretise(s)),
              HasSubstr("largest at degree of freedom 1 and degree of freedom 2"));
  k(0, 0) = 2.001;
  s.parts[0].stiffness = k.sparseView();
  EXPECT_EQ(refusal_of(discretise(s)), "none");
}

}  // namespace
}  // namespace wheeltap::fem
