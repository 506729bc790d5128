#include "fem/structures/modes/structure_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <ctime>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/matrix_structure.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {
namespace {

MemberSection rectangle(double width, double height, double kappa) {
  const double b = std::min(width, height), h = std::max(width, height), r = b / h;
  return {.area = width * height,
          .second_moment_y = width * height * height * height / 12.0,
          .second_moment_z = height * width * width * width / 12.0,
          .torsion_constant = h * b * b * b * (1.0 / 3.0 - 0.21 * r * (1.0 - r * r * r * r / 12.0)),
          .shear_coefficient_z = kappa,
          .shear_coefficient_y = kappa,
          .depth = height};
}

Member member(const Structure& s, std::string name, int a, int b, int elements, Material material,
              MemberSection section) {
  const Vector3 line =
      difference(s.nodes[static_cast<std::size_t>(b)].at, s.nodes[static_cast<std::size_t>(a)].at);
  return {.name = std::move(name),
          .nodes = {a, b},
          .elements = elements,
          .pieces = {{.to = norm(line), .material = material, .section = section}}};
}

void expect_frequencies(const StructureModes& modes, const std::vector<double>& expected,
                        double relative) {
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(modes.frequencies_hz[static_cast<Eigen::Index>(i)], expected[i],
                relative * expected[i])
        << "mode " << i + 1;
  EXPECT_TRUE(modes.certified) << modes.solver;
}

/// Eight arms of 5 m in a plane, pinned at their outer ends, rigidly joined (NAFEMS FV4-like).
Structure cross_of_arms(int elements, double kappa) {
  const Material material{.young = 200e9, .poisson = 0.3, .density = 8000.0};
  Structure s{.dimension = 2, .nodes = {{"hub", {0.0, 0.0, 0.0}}}, .members = {}};
  for (int i = 0; i < 8; ++i) {
    const double angle = kPi / 4.0 * i;
    s.nodes.push_back(
        {"tip " + std::to_string(i + 1), {5.0 * std::cos(angle), 5.0 * std::sin(angle), 0.0}});
    s.members.push_back(member(s, "arm " + std::to_string(i + 1), 0, i + 1, elements, material,
                               rectangle(0.125, 0.125, kappa)));
    s.supports.push_back({.node = i + 1, .fix = {true, true}});
  }
  return s;
}

TEST(StructureModes, EightArms) {
  const StructureModes modes =
      structure_modes(Mesh(cross_of_arms(24, 5.0 / 6.0)).discretisation(), 9);
  expect_frequencies(
      modes, {11.3243, 17.6368, 17.6368, 17.6652, 17.6652, 17.6652, 17.6652, 17.6652, 45.157},
      1e-4);
}

/// Corners 0 … 3 of a square, joined rigidly.
Structure square_frame(int elements, double kappa) {
  const Material material{.young = 200e9, .poisson = 0.3, .density = 8000.0};
  Structure s{.dimension = 2,
              .nodes = {{"A", {0, 0, 0}}, {"B", {10, 0, 0}}, {"C", {10, 10, 0}}, {"D", {0, 10, 0}}},
              .members = {}};
  for (int i = 0; i < 4; ++i)
    s.members.push_back(member(s, "side " + std::to_string(i + 1), i, (i + 1) % 4, elements,
                               material, rectangle(0.25, 0.25, kappa)));
  return s;
}

TEST(StructureModes, FreeSquareFrame) {
  const StructureModes modes =
      structure_modes(Mesh(square_frame(40, 5.0 / 6.0)).discretisation(), 11);
  EXPECT_EQ(modes.rigid_body_modes, 3);
  expect_frequencies(
      modes, {0, 0, 0, 3.2585, 5.6592, 11.1143, 11.1143, 12.7651, 24.4922, 28.4742, 28.4742}, 1e-4);
}

/// Without shear and rotary inertia: the classical tables.
TEST(StructureModes, SlenderLimits) {
  Structure arms = cross_of_arms(24, MemberSection::kNoShear);
  Structure square = square_frame(40, MemberSection::kNoShear);
  arms.rotary_inertia = square.rotary_inertia = false;
  expect_frequencies(
      structure_modes(Mesh(arms).discretisation(), 9),
      {11.3363, 17.6808, 17.6808, 17.7094, 17.7094, 17.7094, 17.7094, 17.7094, 45.345}, 1e-4);
  expect_frequencies(
      structure_modes(Mesh(square).discretisation(), 11),
      {0, 0, 0, 3.2616, 5.6652, 11.1424, 11.1424, 12.8201, 24.6001, 28.6665, 28.6665}, 1e-4);
}

/// Bathe & Wilson 1972, Proc. ASCE 98 (ST6): ten bays, nine storeys, one element per member, lumped
/// masses, no shear deformation.
TEST(StructureModes, BatheWilsonFrame) {
  const Material material{.young = 432000.0, .poisson = 0.3, .density = 1.0};  // kips, feet
  const MemberSection section{.area = 3.0, .second_moment_y = 1.0};
  Structure s{.dimension = 2, .nodes = {}, .members = {}};
  const auto node = [](int column, int storey) { return storey * 11 + column; };
  for (int storey = 0; storey <= 9; ++storey)
    for (int column = 0; column <= 10; ++column)
      s.nodes.push_back({std::to_string(column) + "/" + std::to_string(storey),
                         {20.0 * column, 10.0 * storey, 0.0}});
  for (int storey = 0; storey < 9; ++storey)
    for (int column = 0; column <= 10; ++column)
      s.members.push_back(member(s, "column", node(column, storey), node(column, storey + 1), 1,
                                 material, section));
  for (int storey = 1; storey <= 9; ++storey)
    for (int column = 0; column < 10; ++column)
      s.members.push_back(
          member(s, "beam", node(column, storey), node(column + 1, storey), 1, material, section));
  for (int column = 0; column <= 10; ++column)
    s.supports.push_back({.node = node(column, 0), .fix = {true, true, true, true, true, true}});
  s.mass = Structure::Mass::lumped;
  const Mesh mesh(s);
  EXPECT_EQ(mesh.discretisation().size(), 297);
  EXPECT_EQ(mode_count(mesh.discretisation()), 198);
  const StructureModes modes = structure_modes(mesh.discretisation(), 3);
  EXPECT_TRUE(modes.certified);
  const double expected[] = {0.5895413, 5.526956, 16.58787};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(modes.eigenvalues[i], expected[i], 1e-6 * expected[i]) << i;
}

/// The published three families of a cantilever in space (bending about both axes, torsion and
/// axial), for any direction of the member and its section.
TEST(StructureModes, ASpaceCantileverInAnyDirection) {
  const Material material{.young = 70e9, .poisson = 0.3, .density = 2700.0};
  const MemberSection section = rectangle(0.02, 0.05, 5.0 / 6.0);
  StructureModes straight;
  for (const auto& [tip, up] : {std::pair{Vector3{2, 0, 0}, Vector3{0, 0, 1}},
                                std::pair{Vector3{0, 0, 2}, Vector3{1, 2, 0}},
                                std::pair{Vector3{1.2, -0.96, 1.28}, Vector3{0.3, 0.1, 2}}}) {
    Structure s{.dimension = 3, .nodes = {{"root", {1, 2, 3}}, {"tip", {}}}, .members = {}};
    for (std::size_t k = 0; k < 3; ++k) s.nodes[1].at[k] = s.nodes[0].at[k] + tip[k];
    s.members.push_back(member(s, "arm", 0, 1, 40, material, section));
    s.members[0].up = up;
    s.supports.push_back({.node = 0, .fix = {true, true, true, true, true, true}});
    const Mesh mesh(s);
    const StructureModes modes = structure_modes(mesh.discretisation(), 14);
    EXPECT_TRUE(modes.certified);
    if (straight.eigenvalues.size() == 0) {
      straight = modes;
      // Bending along z equals that of the plane beam.
      const Beam beam{.length = 2.0,
                      .elements = 40,
                      .supports = named_supports("cantilever", 2.0),
                      .material = material,
                      .section = {section.area, section.second_moment_y, 5.0 / 6.0}};
      const Modes plane = modal_analysis(beam, {}, {.modes = 3});
      for (const double f : plane.frequencies_hz)
        EXPECT_LT((modes.frequencies_hz.array() / f - 1.0).abs().minCoeff(), 1e-9);
      // Torsion: f = √(G J / ρ I_p) / (4 L), consistent linear elements 1 + (π h / 2L)² / 24.
      const double polar = section.second_moment_y + section.second_moment_z;
      const double torsion =
          std::sqrt(material.shear_modulus() * section.torsion_constant / (2700.0 * polar)) / 8.0;
      const double mesh_error = std::pow(kPi / 2.0 / 40.0, 2) / 24.0;
      EXPECT_LT(
          (modes.frequencies_hz.array() / (torsion * (1.0 + mesh_error)) - 1.0).abs().minCoeff(),
          1e-6);
    }
    for (Eigen::Index i = 0; i < 14; ++i)
      EXPECT_NEAR(modes.frequencies_hz[i], straight.frequencies_hz[i],
                  1e-10 * straight.frequencies_hz[i]);
  }
}

/// A free space frame has six strain-free rigid motions and the same frequencies in every position
/// and orientation.
TEST(StructureModes, RigidMotionsAndRotationOfASpaceFrame) {
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  Eigen::Matrix3d turn;
  turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  StructureModes first;
  for (const bool turned : {false, true}) {
    Structure s{.dimension = 3, .nodes = {}, .members = {}};
    for (const Vector3& corner :
         {Vector3{0, 0, 0}, Vector3{3, 0, 0}, Vector3{3, 2, 0}, Vector3{0, 2, 0.5}}) {
      const Eigen::Vector3d at =
          turned
              ? Eigen::Vector3d(turn * Eigen::Vector3d(corner.data()) + Eigen::Vector3d(5, -4, 9))
              : Eigen::Vector3d(corner.data());
      s.nodes.push_back({"n", {at[0], at[1], at[2]}});
    }
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}}) {
      s.members.push_back(member(s, "m", a, b, 6, material, rectangle(0.05, 0.08, 5.0 / 6.0)));
      const Eigen::Vector3d up =
          turned ? Eigen::Vector3d(turn * Eigen::Vector3d::UnitZ()) : Eigen::Vector3d::UnitZ();
      s.members.back().up = {up[0], up[1], up[2]};
    }
    s.members[1].ends[0].offset = {0, 0, 0};
    const Mesh mesh(s);
    const Discretisation& d = mesh.discretisation();
    ASSERT_EQ(d.rigid_motions.cols(), 6);
    for (const auto& motion : d.rigid_motions.colwise())
      EXPECT_LT(d.energy(motion), 1e-24 * d.uncancelled_energy(motion));
    const StructureModes modes = structure_modes(d, 16);
    EXPECT_TRUE(modes.certified);
    EXPECT_EQ(modes.rigid_body_modes, 6);
    if (!turned) {
      first = modes;
      continue;
    }
    for (Eigen::Index i = 6; i < 16; ++i)
      EXPECT_NEAR(modes.frequencies_hz[i], first.frequencies_hz[i], 1e-9 * first.frequencies_hz[i]);
  }
}

/// A hinge and a rigid joint are the limits of a flexible joint; a joint of stiffness k acts like a
/// spring of that stiffness.
TEST(StructureModes, JointStiffnessInterpolatesBetweenHingeAndRigid) {
  Structure s = square_frame(10, 5.0 / 6.0);
  const auto f = [&](double stiffness) {
    s.members[0].ends[1].rotation.fill(stiffness);
    return structure_modes(Mesh(s).discretisation(), 6).frequencies_hz[3];
  };
  const double hinge = f(0.0), rigid = f(MemberEnd::kRigid);
  EXPECT_LT(hinge, 0.95 * rigid);
  EXPECT_NEAR(f(1e-3), hinge, 1e-9 * hinge);
  EXPECT_NEAR(f(1e16), rigid, 1e-6 * rigid);
  const double middle = f(1e7);
  EXPECT_GT(middle, hinge);
  EXPECT_LT(middle, rigid);
}

/// Euler: P = π² EI / L² reduces the first frequency of a pinned column to zero, by f² = f₀² (1 -
/// P/P_E).
TEST(StructureModes, AxialLoadReducesFrequenciesUpToBuckling) {
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  Structure s{.dimension = 2, .nodes = {{"foot", {0, 0, 0}}, {"head", {0, 4, 0}}}, .members = {}};
  s.members.push_back(
      member(s, "column", 0, 1, 40, material, rectangle(0.05, 0.05, MemberSection::kNoShear)));
  s.supports = {{.node = 0, .fix = {true, true}}, {.node = 1, .fix = {true, false}}};
  s.rotary_inertia = false;
  const double euler = kPi * kPi * 210e9 * s.members[0].pieces[0].section.second_moment_y / 16.0;
  const double f0 = structure_modes(Mesh(s).discretisation(), 1).frequencies_hz[0];
  for (const double share : {-1.0, 0.5, 0.9, 0.9999}) {
    s.members[0].axial_force = -share * euler;
    const double f = structure_modes(Mesh(s).discretisation(), 1).frequencies_hz[0];
    EXPECT_NEAR(f * f, f0 * f0 * (1.0 - share), 2e-6 * f0 * f0) << share;
  }
  s.members[0].axial_force = -1.001 * euler;
  EXPECT_THROW((void)structure_modes(Mesh(s).discretisation(), 1), InvalidStructure);
}

TEST(StructureModes, NamesAMechanism) {
  Structure s = square_frame(4, 5.0 / 6.0);
  s.supports = {{.node = 0, .fix = {true, true}}, {.node = 1, .fix = {true, true}}};
  for (Member& m : s.members)
    for (MemberEnd& end : m.ends) end.rotation.fill(0.0);
  try {
    (void)structure_modes(Mesh(s).discretisation(), 3);
    FAIL() << "a four-bar linkage stood";
  } catch (const InvalidStructure& error) {
    EXPECT_NE(std::string(error.what()).find("mechanism"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("x"), std::string::npos) << error.what();
  }
}

/// The four-storey benchmark building of the IASC-ASCE task group (12 degrees of freedom, with
/// chains of storeys in x and y), intact and with its first damage case.
TEST(StructureModes, IascAsceBuilding) {
  const std::vector<double> masses = {3452.4, 2652.4, 2652.4, 1809.9};
  const auto frequencies = [&](double storey, double first) {
    LumpedChain chain{.masses = masses, .links = {}};
    for (int i = 0; i < 4; ++i)
      chain.links.push_back(
          {"storey " + std::to_string(i + 1), {i, i + 1}, i == 0 ? first : storey});
    return structure_modes(discretise(chain), 4);
  };
  expect_frequencies(frequencies(67.90e6, 67.90e6), {9.411, 25.544, 38.662, 48.006}, 1e-4);
  expect_frequencies(frequencies(106.60e6, 106.60e6), {11.791, 32.006, 48.443, 60.151}, 1e-4);
  expect_frequencies(frequencies(67.90e6, 19.67e6), {6.240}, 1e-4);
  expect_frequencies(frequencies(106.60e6, 58.37e6), {9.909}, 1e-4);
}

TEST(StructureModes, FreeChainHasARigidBodyMode) {
  LumpedChain chain{.masses = {1.0, 1.0, 2.0},
                    .links = {{"a", {1, 2}, 100.0}, {"b", {2, 3}, 50.0}}};
  const StructureModes modes = structure_modes(discretise(chain), 3);
  EXPECT_EQ(modes.rigid_body_modes, 1);
  EXPECT_EQ(modes.frequencies_hz[0], 0.0);
  EXPECT_GT(modes.frequencies_hz[1], 0.0);
}

// Regression: the search for connected masses took quadratic time; 20 000 masses needed a minute.
TEST(StructureModes, LongChainsAreAssembledInLinearTime) {
  const auto seconds = [](int n) {
    LumpedChain chain;
    chain.masses.assign(static_cast<std::size_t>(n), 1.0);
    for (int i = n; i-- > 1;)
      chain.links.push_back({"", {i, i + 1}, 1.0});  // the ground comes last
    chain.links.push_back({"", {0, 1}, 1.0});
    const std::clock_t began = std::clock();
    EXPECT_EQ(discretise(chain).rigid_motions.cols(), 0);
    return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  };
  const double few = seconds(10'000);
  EXPECT_LT(seconds(160'000), 64.0 * few + 0.1) << "linear: 16 times as long";
}

TEST(StructureModes, EachFreeGroupOfMassesHasARigidBodyMode) {
  LumpedChain chain{.masses = {1.0, 1.0, 1.0, 1.0, 1.0},
                    .links = {{"a", {4, 5}, 1.0}, {"b", {2, 4}, 1.0}, {"c", {0, 1}, 1.0}}};
  const Eigen::MatrixXd motions = discretise(chain).rigid_motions;
  ASSERT_EQ(motions.cols(), 2);
  EXPECT_EQ(motions.col(0), (Eigen::VectorXd(5) << 0, 1, 0, 1, 1).finished());
  EXPECT_EQ(motions.col(1), (Eigen::VectorXd(5) << 0, 0, 1, 0, 0).finished());
}

TEST(StructureModes, MatricesGiveTheModesOfTheirStructure) {
  const Mesh mesh(cross_of_arms(6, 5.0 / 6.0));
  const Discretisation& d = mesh.discretisation();
  MatrixStructure s{.mass = d.mass,
                    .parts = {{"half", 0.5 * d.stiffness, 0.0}, {"rest", 0.25 * d.stiffness, 1.0}}};
  const StructureModes given = structure_modes(discretise(s), 9), own = structure_modes(d, 9);
  for (Eigen::Index i = 0; i < 9; ++i)
    EXPECT_NEAR(given.frequencies_hz[i], own.frequencies_hz[i], 1e-8 * own.frequencies_hz[i]);
  s.parts[0].stiffness.coeffRef(0, 3) += 1e9;
  EXPECT_THROW((void)discretise(s), InvalidStructure);
}

/// Scaling a part equals assembly with another α; two scalings equal one by the product.
TEST(StructureModes, ScaledPartEqualsAnotherAlpha) {
  const Mesh mesh(cross_of_arms(6, 5.0 / 6.0));
  const Discretisation& d = mesh.discretisation();
  MatrixStructure s{.mass = d.mass,
                    .parts = {{"half", 0.5 * d.stiffness, 0.0}, {"rest", 0.25 * d.stiffness, 1.0}}};
  StructureChange change{
      .scalings = {{.part = 1, .remaining = 0.5}, {.part = 1, .remaining = 0.6}}};
  compound(change);
  ASSERT_EQ(change.scalings.size(), 1U);
  EXPECT_FALSE(change.empty());
  const StructureModes scaled = structure_modes(changed(discretise(s), change), 9);
  s.parts[1].change = 2.0 * 0.3 - 1.0;
  const StructureModes assembled = structure_modes(discretise(s), 9);
  for (Eigen::Index i = 0; i < 9; ++i)
    EXPECT_NEAR(scaled.frequencies_hz[i], assembled.frequencies_hz[i],
                1e-9 * assembled.frequencies_hz[i]);
  EXPECT_THROW((void)changed(discretise(s), {.scalings = {{.part = 2}}}), std::invalid_argument);
  EXPECT_THROW((void)changed(discretise(s), {.scalings = {{.part = 0, .remaining = 0.0}}}),
               std::invalid_argument);
  // Structures of members have no such parts, and the change has no low rank.
  EXPECT_THROW((void)changed(d, {.scalings = {{.part = 0, .remaining = 0.5}}}),
               std::invalid_argument);
}

/// A beam with springs and inner supports is a plane structure with the same frequencies.
TEST(StructureModes, BeamEqualsItsPlaneStructure) {
  Beam beam{.length = 1.2,
            .elements = 24,
            .supports = {{.at = 0.0, .rotation = true, .stiffness = {}},
                         {.at = 0.5, .stiffness = {}},
                         {.at = 1.2, .deflection = true, .rotation = true, .stiffness = 1e4}},
            .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
            .section = {.area = 1e-3, .second_moment = 4e-8, .shear_coefficient = 0.85}};
  const Modes own = modal_analysis(beam, {}, {.modes = 8});
  const StructureModes modes = structure_modes(Mesh(as_structure(beam)).discretisation(), 8);
  for (Eigen::Index i = 0; i < 8; ++i)
    EXPECT_NEAR(modes.frequencies_hz[i], own.frequencies_hz[i], 1e-9 * own.frequencies_hz[i]);
  beam.supports.clear();
  EXPECT_EQ(structure_modes(Mesh(as_structure(beam)).discretisation(), 4).rigid_body_modes, 2);
  beam.supports = {{.at = 0.51, .stiffness = {}}};
  EXPECT_THROW((void)as_structure(beam), std::invalid_argument);
}

/// Masses count relative to their own size, however large others are; dependent motions do not
/// count.
TEST(StructureModes, CountsMassesRelativeToTheirSize) {
  const auto count = [](const Eigen::MatrixXd& mass) {
    Discretisation d;
    d.mass = mass.sparseView();
    return mode_count(d);
  };
  EXPECT_EQ(count(Eigen::Vector3d(1e300, 1.0, 0.0).asDiagonal()), 2);
  Eigen::MatrixXd rod(2, 2);  // one mass that takes part in two motions
  rod << 4.0, 2.0, 2.0, 1.0;
  EXPECT_EQ(count(rod), 1);
  Eigen::MatrixXd beside = Eigen::MatrixXd::Zero(4, 4);
  beside.topLeftCorner(2, 2) = rod;
  beside(3, 3) = 1e20;
  EXPECT_EQ(count(beside), 2);
  EXPECT_EQ(count(Eigen::MatrixXd::Zero(2, 2)), 0);
}

// Regression: a mass on a spring so soft, or so stiff, that rounding removes its stiffness crashed
// an empty search. Expects a result or an exception.
TEST(StructureModes, SolvesOrRejectsSpringsOfAnyStiffness) {
  int refused = 0;
  for (int exponent = -40; exponent <= 40; ++exponent) {
    for (const int link : {0, 2}) {
      LumpedChain chain{.masses = {12.0, 12.0, 10.0},
                        .links = {{"a", {0, 1}, 35e3}, {"b", {1, 2}, 35e3}, {"c", {2, 3}, 35e3}}};
      chain.links[static_cast<std::size_t>(link)].stiffness = std::pow(10.0, exponent);
      try {
        const StructureModes modes = structure_modes(discretise(chain), 3);
        for (const double f : modes.frequencies_hz) EXPECT_TRUE(f > 0.0) << exponent;
      } catch (const std::invalid_argument&) {
        ++refused;
      }
    }
  }
  EXPECT_LT(refused, 120) << "of 162";
}

TEST(StructureModes, CountThrowsAtAnEigenvalue) {
  Discretisation d;
  d.mass = Eigen::MatrixXd(Eigen::Vector2d(1.0, 1.0).asDiagonal()).sparseView();
  d.stiffness = Eigen::MatrixXd(Eigen::Vector2d(4.0, 9.0).asDiagonal()).sparseView();
  EXPECT_EQ(eigenvalues_below(d, 5.0), 1);
  EXPECT_THROW(static_cast<void>(eigenvalues_below(d, 4.0)), std::domain_error);
}

}  // namespace
}  // namespace wheeltap::fem
