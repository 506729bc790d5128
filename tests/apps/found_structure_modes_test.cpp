// `wheeltap modes` of structures on the command line; published frequencies from case files.
#include "apps/runs/found_structure_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/results/structure_drawing.hpp"
#include "io/file_error.hpp"
#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// A frame of rectangular bars in the plane, κ = 5/6.
json frame(double side, double young, double density, const json& nodes, const json& members,
           int elements) {
  json list = json::array();
  for (const json& ends : members)
    list.push_back({{"nodes", ends}, {"elements", elements}, {"material", "m"}, {"section", "s"}});
  return {{"kind", "damage"},
          {"structure",
           {{"materials", {{"m", {{"young", young}, {"poisson", 0.3}, {"density", density}}}}},
            {"sections",
             {{"s",
               {{"shape", "rectangle"},
                {"width", side},
                {"height", side},
                {"shear_coefficient", 5.0 / 6.0}}}}},
            {"nodes", nodes},
            {"members", list}}}};
}

json eight_arms() {
  json nodes = {{"O", {0, 0}}}, members = json::array(), supports = json::array();
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::numbers::pi / 4;
    const std::string name = "tip " + std::to_string(i + 1);
    nodes[name] = {5 * std::cos(angle), 5 * std::sin(angle)};
    members.push_back({"O", name});
    supports.push_back({{"node", name}, {"fix", {"x", "y"}}});
  }
  json out = frame(0.125, 200e9, 8000, nodes, members, 24);
  out["structure"]["supports"] = supports;
  return out;
}

TEST(StructureCommand, EightArms) {
  const Workspace where;
  const Outcome ran = wheeltap(
      where, "modes " + where.write_json("arms.json", eight_arms()).string() + " --modes 9 --json");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json out = json::parse(ran.out);
  EXPECT_TRUE(out["certified"].get<bool>());
  EXPECT_EQ(out["rigid_body_modes"], 0);
  expect_near(out["frequencies_hz"].get<std::vector<double>>(),
              {11.3243, 17.6368, 17.6368, 17.6652, 17.6652, 17.6652, 17.6652, 17.6652, 45.157},
              1e-4);
}

TEST(StructureCommand, FreeSquareFrame) {
  const json square =
      frame(0.25, 200e9, 8000, {{"A", {0, 0}}, {"B", {10, 0}}, {"C", {10, 10}}, {"D", {0, 10}}},
            json::parse(R"([["A", "B"], ["B", "C"], ["C", "D"], ["D", "A"]])"), 24);
  const Workspace where;
  const std::string path = where.write_json("square.json", square).string();
  const Outcome ran = wheeltap(where, "modes " + path + " --modes 11 --json");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json out = json::parse(ran.out);
  EXPECT_EQ(out["rigid_body_modes"], 3);
  std::vector<double> f = out["frequencies_hz"].get<std::vector<double>>();
  EXPECT_EQ((std::vector{f[0], f[1], f[2]}), (std::vector{0.0, 0.0, 0.0}));
  f.erase(f.begin(), f.begin() + 3);
  expect_near(f, {3.2585, 5.6592, 11.1143, 11.1143, 12.7651, 24.4922, 28.4742, 28.4742}, 2e-5);
  EXPECT_THAT(wheeltap(where, "modes " + path + " --modes 3").out, HasSubstr("(rigid body)"));
}

TEST(StructureCommand, BatheWilsonFrame) {
  json nodes = json::object(), members = json::array(), supports = json::array();
  const auto name = [](int column, int level) {
    return std::to_string(column) + "." + std::to_string(level);
  };
  for (int c = 0; c <= 10; ++c)
    for (int l = 0; l <= 9; ++l) {
      nodes[name(c, l)] = {20.0 * c, 10.0 * l};
      if (l > 0) members.push_back({name(c, l - 1), name(c, l)});
      if (l > 0 && c > 0) members.push_back({name(c - 1, l), name(c, l)});
      if (l == 0) supports.push_back({{"node", name(c, 0)}, {"fix", {"x", "y", "rotation"}}});
    }
  json tall = frame(1.0, 432000, 1.0, nodes, members, 1);
  tall["structure"]["sections"]["s"] = {
      {"area", 3.0}, {"second_moment", 1.0}, {"shear_coefficient", "none"}};
  tall["structure"]["supports"] = supports;
  tall["structure"]["mass"] = "lumped";
  std::vector<double> eigenvalues;
  for (const double f : frequencies(parsed(tall).nominal, 3))
    eigenvalues.push_back(std::pow(2 * std::numbers::pi * f, 2));
  expect_near(eigenvalues, {0.5895413, 5.526956, 16.58787}, 1e-5);
}

TEST(StructureCommand, IascAsceBuilding) {
  const std::vector<double> masses = {3452.4, 2652.4, 2652.4, 1809.9};
  const auto storeys = [&](double first, double k) {
    return frequencies(parsed(chain(masses, {first, k, k, k})).nominal, 4);
  };
  expect_near(storeys(67.90e6, 67.90e6), {9.411, 25.544, 38.662, 48.006}, 1e-4);
  expect_near(storeys(106.60e6, 106.60e6), {11.791, 32.006, 48.443, 60.151}, 1e-4);
  expect_near(storeys(19.67e6, 67.90e6), {6.240}, 1e-4);
  expect_near(storeys(58.37e6, 106.60e6), {9.909}, 1e-4);
}

TEST(StructureCommand, PedestrianBridge) {
  const std::filesystem::path data =
      std::filesystem::path(WHEELTAP_DATA) / "../../shared/data/updating-structures";
  const auto file = data / "pedestrian_bridge_matrices.mat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  json stiffness = {
      {"frame", "K_Frame"}, {"truss", "K_Truss"}, {"springs", {"K_y1", "K_z1", "K_y2", "K_z2"}}};
  for (int i = 1; i <= 11; ++i) stiffness["deck"].push_back("K_Conc" + std::to_string(i));
  const json bridge = {
      {"kind", "update"},
      {"structure", {{"matrices", file.string()}, {"mass", "M0"}, {"stiffness", stiffness}}}};
  const Workspace where;
  const Outcome ran = wheeltap(
      where, "modes " + where.write_json("bridge.json", bridge).string() + " --modes 5 --json");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json out = json::parse(ran.out);
  EXPECT_EQ(out["degrees_of_freedom"], 946);
  expect_near(out["frequencies_hz"].get<std::vector<double>>(),
              {4.6596, 4.8750, 6.6540, 9.9009, 11.3806}, 1e-5);
}

TEST(StructureCommand, TheContractsPortalFrame) {
  const Workspace where;
  const std::string path = where.write_json("portal.json", portal_frame()).string();
  const Outcome ran = wheeltap(where, "modes " + path);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("Portal frame"));
  EXPECT_THAT(ran.out, HasSubstr("at the priors' medians: E = 2.09"));
  EXPECT_THAT(ran.out, HasSubstr("Certified: no mode below"));
  const json shown =
      json::parse(wheeltap(where, "modes " + path + " --modes 3 --json --shapes").out);
  EXPECT_EQ(shown["frequencies_hz"].size(), 3U);
  ASSERT_EQ(shown["shapes"].size(), 3U);
  EXPECT_EQ(shown["shapes"][0]["A"]["x"], 0.0);
  EXPECT_NE(shown["shapes"][0]["B"]["x"], 0.0);
  EXPECT_TRUE(shown["shapes"][0]["C"].contains("rotation"));
  EXPECT_EQ(shown["parameters"].size(), 1U);
}

TEST(StructureCommand, SaysWhatMovesMost) {
  const auto largest = [](const json& structure_case, int mode) {
    const auto structure = drawn(parsed(structure_case).nominal);
    const auto modes = fem::structure_modes(structure.discretisation, mode);
    return largest_motion(structure.drawing, modes.shapes.col(mode - 1));
  };
  EXPECT_EQ(largest(cantilever_in_space(), 1), "node B, y");
  EXPECT_EQ(largest(cantilever_in_space(), 2), "node B, z");
  EXPECT_EQ(largest(cantilever_in_space({0, 0, 1}), 1), "node B, x");
  // The antinode of the first simply supported mode is at midspan.
  json beam = cantilever_in_space();
  beam["structure"]["supports"] = {{{"node", "A"}, {"fix", {"x", "y", "z", "rx"}}},
                                   {{"node", "B"}, {"fix", {"y", "z"}}}};
  EXPECT_EQ(largest(beam, 1), "arm at 1 m, y");
  // Only torsion is left.
  json shaft = beam;
  shaft["structure"]["supports"] = {{{"node", "A"}, {"fix", {"x", "y", "z", "rx", "ry", "rz"}}},
                                    {{"node", "B"}, {"fix", {"x", "y", "z", "ry", "rz"}}}};
  shaft["structure"]["members"][0]["elements"] = 1;
  EXPECT_EQ(largest(shaft, 1), "rotation of node B about x");
  EXPECT_EQ(largest(chain({1, 1}, {1, 1}), 1), "mass 2, x");
}

TEST(StructureCommand, DrawsForParaView) {
  const Workspace where;
  const std::string path = where.write_json("portal.json", portal_frame()).string();
  const auto vtk = where / "portal.vtk";
  ASSERT_EQ(wheeltap(where, "modes " + path + " --modes 2 --vtk " + vtk.string()).exit_code, 0);
  std::istringstream text(read_all(vtk));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "# vtk DataFile Version 3.0");
  std::getline(text, line);
  EXPECT_EQ(line, "Portal frame");
  std::getline(text, line);
  std::getline(text, line);
  EXPECT_EQ(line, "DATASET POLYDATA");
  std::string word;
  std::size_t points = 0, lines = 0, numbers = 0, fields = 0;
  text >> word >> points >> word;
  for (std::size_t i = 0; i < 3 * points; ++i) text >> word;
  text >> word >> lines >> numbers;
  EXPECT_EQ(word, "LINES");
  EXPECT_EQ(lines, 4U) << "three members and a spring";
  std::size_t read = 0;
  for (std::size_t l = 0; l < lines; ++l) {
    std::size_t corners = 0, point = 0;
    text >> corners;
    for (std::size_t c = 0; c < corners; ++c) {
      text >> point;
      EXPECT_LT(point, points);
    }
    read += corners + 1;
  }
  EXPECT_EQ(read, numbers);
  std::size_t of = 0;
  text >> word >> of;
  EXPECT_EQ(word, "POINT_DATA");
  EXPECT_EQ(of, points);
  while (text >> word && word == "VECTORS") {
    std::string name, type;
    text >> name >> type;
    EXPECT_THAT(name, testing::StartsWith("mode_0" + std::to_string(fields + 1)));
    double largest = 0.0;
    for (std::size_t i = 0; i < points; ++i) {
      double x = 0, y = 0, z = 0;
      text >> x >> y >> z;
      largest = std::max(largest, std::hypot(x, y, z));
    }
    EXPECT_NEAR(largest, 1.0, 1e-12);
    ++fields;
  }
  EXPECT_EQ(fields, 2U);
}

TEST(StructureCommand, ShapesOfLinesFollowTheElements) {
  // Between two nodes of one element the line is the deflection, not a chord: the tip slope of a
  // cantilever is 1.376 times that of the chord.
  json one = cantilever_in_space();
  one["structure"]["members"][0]["elements"] = 1;
  const auto structure = drawn(parsed(one).nominal);
  const auto modes = fem::structure_modes(structure.discretisation, 1);
  const auto& line = structure.drawing.lines[0];
  const auto y = [&](std::size_t i) {
    return structure.drawing.points[static_cast<std::size_t>(line[i])].translation[1].of(
        modes.shapes.col(0));
  };
  const std::size_t last = line.size() - 1;
  EXPECT_EQ(last, 16U);
  EXPECT_NEAR((y(last) - y(last - 1)) * static_cast<double>(last) / y(last), 1.37, 0.03);
}

// ---- invalid cases

void expect_ends_with_65(const json& structure_case, const std::string& message) {
  const Workspace where;
  const std::string path = where.write_json("bad.json", structure_case).string();
  const Outcome ran = wheeltap(where, "modes " + path);
  EXPECT_EQ(ran.exit_code, 65) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("wheeltap: " + path + ": " + message));
  EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
}

TEST(StructureCommand, MechanismsAndBucklingAreNamed) {
  json loose = portal_frame();
  loose["structure"].erase("springs");
  loose["structure"]["members"][1]["ends"]["B"] = "hinge";
  loose["structure"]["members"][0]["ends"] = {{"A", "hinge"}};
  loose["structure"]["supports"][1].erase("stiffness");
  loose["structure"]["members"][2].erase("axial_force");
  expect_ends_with_65(loose, "/structure: is a mechanism: nothing resists");
  json buckled = portal_frame();
  buckled["structure"]["members"][2]["axial_force"] = -1e5;
  expect_ends_with_65(buckled, "/structure: the axial forces exceed the buckling load");
}

TEST(StructureCommand, BeamAndStructureAreNotMixed) {
  json both = portal_frame();
  both["beam"] = json::object();
  expect_ends_with_65(both, "/structure: replaces \"beam\": give only one of the two keys");
  const Workspace where;
  const std::string path = where.write_json("portal.json", portal_frame()).string();
  const Outcome ran = wheeltap(where, "table " + path + " -o " + (where / "t.nc").string());
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("/structure: an emulator is trained on a beam"));
  const std::string beam = where.write_json("beam.json", small_case()).string();
  EXPECT_EQ(wheeltap(where, "modes " + beam + " --vtk " + (where / "b.vtk").string()).exit_code,
            64);
  const Outcome no_truth = wheeltap(where, "modes " + path + " --truth");
  EXPECT_EQ(no_truth.exit_code, 65);
  EXPECT_THAT(no_truth.err, HasSubstr("--truth needs it"));
  EXPECT_EQ(wheeltap(where, "modes " + path + " --modes 1000").exit_code, 65);
}

// ---- matrices

constexpr const char* kHead = "%%MatrixMarket matrix coordinate real ";

class MatrixCase : public testing::Test {
 protected:
  MatrixCase() {
    std::filesystem::create_directories(where_ / "model");
    write("M", "symmetric\n2 2 2\n1 1 1\n2 2 2\n");
    write("K1", "symmetric\n2 2 1\n1 1 100\n");
    write("K2", "symmetric\n2 2 3\n1 1 50\n2 1 -50\n2 2 50\n");
    where_.write("dofs.csv", "number,place,direction\n2,deck,z\n");
    case_ = {
        {"kind", "update"},
        {"structure",
         {{"matrices", "model"}, {"mass", "M"}, {"stiffness", {{"post", "K1"}, {"deck", "K2"}}}}}};
  }
  void write(const std::string& name, const std::string& text) {
    where_.write("model/" + name + ".mtx", kHead + text);
  }
  [[nodiscard]] identification::StructureModel read() const {
    return parsed(case_, nullptr, where_ / "case.json");
  }
  void refused(const std::string& message) const {
    try {
      (void)read();
      ADD_FAILURE() << "accepted; expected: " << message;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::bad_input);
      EXPECT_THAT(failure.what(), HasSubstr(message));
    }
  }
  Workspace where_;
  json case_;
};

TEST_F(MatrixCase, SumsScaleAndNames) {
  const auto plain = frequencies(read().nominal, 2);
  // det([150 - λ, -50; -50, 50 - 2λ]) = 0.
  const double root = std::sqrt(175.0 * 175.0 / 4 - 2500.0);
  for (const int i : {0, 1})
    EXPECT_NEAR(std::pow(2 * std::numbers::pi * plain[static_cast<std::size_t>(i)], 2),
                87.5 + (i == 0 ? -root : root), 1e-9);
  json& s = case_["structure"];
  s["stiffness"] = {{"all", {"K1", "K2"}}};
  s["dofs"] = "dofs.csv";
  expect_near(frequencies(read().nominal, 2), plain, 1e-14);
  const auto names = std::get<fem::MatrixStructure>(read().nominal).names;
  EXPECT_EQ(names[0].place, "degree of freedom 1");
  EXPECT_EQ(names[1].place, "deck");
  EXPECT_EQ(names[1].direction, "z");
  for (const char* key : {"scale", "change"}) {
    json unknown = case_;
    unknown["structure"][key] = {{"all", "a"}};
    unknown["parameters"]["a"] = {{"uniform", {0.1, 9.0}}};
    const auto model = parsed(unknown, nullptr, where_ / "case.json");
    const double four = std::string(key) == "scale" ? 4.0 : 3.0;
    EXPECT_NEAR(frequencies(model.at(std::vector{four}), 1)[0], 2 * plain[0], 1e-12);
  }
}

TEST_F(MatrixCase, Refusals) {
  json& s = case_["structure"];
  s["stiffness"]["post"] = "K9";
  refused("/structure/stiffness/post: \"K9\": ");
  refused("has no file K9.mtx; its files: K1, K2, M");
  s["stiffness"]["post"] = "K1";
  s["scale"] = {{"dek", 1}};
  refused("/structure/scale/dek: 1: \"stiffness\" has no substructure");
  s["scale"] = {{"deck", 1}};
  s["change"] = {{"deck", 0}};
  refused("/structure/change/deck: 0: contradicts \"scale\"");
  s.erase("scale");
  s["change"] = {{"deck", -1}};
  refused("/structure/change/deck: -1: must be above -1");
  s.erase("change");
  s.erase("mass");
  refused("/structure/mass: is missing");
  s["mass"] = "M";
  write("K3", "general\n2 2 2\n1 2 1\n2 1 2\n");
  s["stiffness"]["post"] = "K3";
  refused("/structure/stiffness/post: \"K3\": the stiffness matrix \"post\" is not symmetric");
  write("K3", "general\n3 3 1\n1 1 1\n");
  refused(
      "/structure/stiffness/post: \"K3\": the stiffness matrix \"post\" is 3 x 3: must be 2 x 2");
  s["stiffness"]["post"] = {"K1", "K3"};
  refused("/structure/stiffness/post/1: \"K3\": is 3 x 3: must be 2 x 2");
  s["stiffness"]["post"] = "K1";
  s["dofs"] = "dofs.csv";
  for (const auto& [rows, message] :
       {std::pair{"3,deck,z\n", "number '3' must be a whole number from 1 to 2"},
        std::pair{"1,a,x\n1,b,x\n", "is listed twice"},
        std::pair{"1,,x\n", "place must not be empty"}}) {
    where_.write("dofs.csv", std::string("number,place,direction\n") + rows);
    EXPECT_THROW((void)read(), io::FileError);
    try {
      (void)read();
    } catch (const io::FileError& error) {
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  }
  where_.write("dofs.csv", "number,where\n1,x\n");
  refused("/structure/dofs: \"dofs.csv\": has no column \"place\"");
  s["matrices"] = "nowhere";
  EXPECT_THROW((void)read(), io::FileError);
}

// ---- starters

class StructureStarter : public testing::TestWithParam<std::string> {};

TEST_P(StructureStarter, RunsAsItIs) {
  const Workspace where;
  const std::string folder = (where / "new").string();
  const Outcome init = wheeltap(where, "init damage --structure " + GetParam() + " -o " + folder);
  ASSERT_EQ(init.exit_code, 0) << init.err;
  const Outcome modes = wheeltap(where, "modes " + folder + "/damage.json --json");
  ASSERT_EQ(modes.exit_code, 0) << modes.err;
  EXPECT_GT(json::parse(modes.out)["frequencies_hz"][0].get<double>(), 0.1);
  EXPECT_EQ(wheeltap(where, "init damage --structure " + GetParam() + " -o " + folder).exit_code,
            73);
  // The text matches the behaviour.
  EXPECT_THAT(init.out, HasSubstr("wheeltap damage "));
  const Outcome damage = wheeltap(
      where, "damage " + folder + "/damage.json -o " + folder + "/results --quick --quiet");
  EXPECT_EQ(damage.exit_code, 0) << damage.err;
  if (GetParam() != "beam") {
    EXPECT_THAT(read_all(folder + "/damage.md"),
                HasSubstr("| `structure.members[].axial_force` |"));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, StructureStarter,
                         testing::Values("beam", "frame", "building", "matrices"),
                         [](const auto& kind) { return kind.param; });

TEST(StructureStarters, OthersAreRefused) {
  const Workspace where;
  const Outcome ran = wheeltap(where, "init damage --structure ship -o " + (where / "x").string());
  EXPECT_EQ(ran.exit_code, 64);
  EXPECT_THAT(ran.err, HasSubstr("starts from beam, building, frame, matrices"));
  EXPECT_EQ(wheeltap(where, "init sid --structure frame -o " + (where / "x").string()).exit_code,
            64);
}

// Fault: near a hinge, rounding errors made the mass of the joint's rotation negative, and the
// program stopped with "lost mass: exceeds the mass of the structure".
TEST(FoundStructureModes, ALooseJointTendsToAHinge) {
  const Workspace where;
  json frame = portal_frame();
  frame.erase("baseline");
  for (json& member : frame["structure"]["members"]) member.erase("ends");
  frame["data"] = {{"cov", 0.002}, {"modes", 3}};
  frame["damage"] = frame["damage"][1];
  const auto found = [&](double reduction) {
    frame["damage"]["truth"] = {{{"node", "B"}, {"reduction", reduction}}};
    const Outcome ran = wheeltap(
        where, "modes --truth --json --modes 6 " + where.write_json("f.json", frame).string());
    EXPECT_EQ(ran.exit_code, 0) << reduction << ran.err;
    return ran.exit_code == 0 ? json::parse(ran.out)["frequencies_hz"].get<std::vector<double>>()
                              : std::vector<double>(6, 0.0);
  };
  const auto nearly = found(0.99999);
  for (const double reduction : {0.999999, 0.9999999}) {
    const auto hinged = found(reduction);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(hinged[i] / nearly[i], 1.0, 1e-5);
  }
}

}  // namespace
}  // namespace wheeltap::apps
