// Cases with stiffness loss of substructures given by matrices.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kMass = 1000.0, kStiffness = 2e6;
constexpr double kCov = 0.004;
const std::vector<std::string> kNames = {"lower", "middle", "upper"};
// Substructure of each of the five storeys.
constexpr std::array kPart = {0, 0, 1, 2, 2};

fem::Discretisation storeys(const std::vector<double>& remaining) {
  fem::LumpedChain chain;
  for (int i = 0; i < 5; ++i) {
    chain.masses.push_back(kMass);
    chain.links.push_back(
        {.name = std::to_string(i),
         .between = {i, i + 1},
         .stiffness =
             kStiffness * remaining[static_cast<std::size_t>(kPart[static_cast<std::size_t>(i)])]});
  }
  return fem::discretise(chain);
}

std::vector<double> frequencies(const std::vector<double>& remaining, int modes) {
  const Eigen::VectorXd found = fem::structure_modes(storeys(remaining), modes).frequencies_hz;
  return {found.begin(), found.end()};
}

// A folder with the matrices, and a case about it.
class SubstructureDamage : public testing::Test {
 protected:
  SubstructureDamage() {
    std::filesystem::create_directory(where / "model");
    std::string mass = header(5);
    for (int i = 1; i <= 5; ++i) mass += entry(i, i, kMass);
    static_cast<void>(where.write("model/M.mtx", mass));
    for (std::size_t part = 0; part < kNames.size(); ++part) {
      std::string k = header(0);
      int entries = 0;
      for (int i = 0; i < 5; ++i) {
        if (kPart[static_cast<std::size_t>(i)] != static_cast<int>(part)) continue;
        k += entry(i + 1, i + 1, kStiffness);
        entries += i > 0 ? 3 : 1;
        if (i > 0) k += entry(i, i, kStiffness) + entry(i + 1, i, -kStiffness);
      }
      k.replace(0, header(0).size(), header(entries));
      static_cast<void>(where.write("model/" + kNames[part] + ".mtx", k));
    }
    for (const std::string& name : kNames) given["structure"]["stiffness"][name] = name;
  }
  static std::string header(int entries) {
    return "%%MatrixMarket matrix coordinate real symmetric\n5 5 " + std::to_string(entries) + "\n";
  }
  static std::string entry(int row, int column, double value) {
    return std::to_string(row) + " " + std::to_string(column) + " " + std::to_string(value) + "\n";
  }
  [[nodiscard]] json run(const json& one, const std::string& name,
                         const std::string& options = "") const {
    const Outcome ran =
        wheeltap(where, "damage " + where.write_json(name + ".json", one).string() + " -o " +
                            (where / name).string() + " --quiet " + options);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(where / name / "summary.json"));
  }
  void refused(const json& one, const std::string& words) const {
    const Outcome ran = wheeltap(where, "damage " + where.write_json("bad.json", one).string() +
                                            " -o " + (where / "bad").string());
    EXPECT_EQ(ran.exit_code, 65) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(words));
  }
  Workspace where;
  json given = {{"kind", "damage"},
                {"structure", {{"matrices", "model"}, {"mass", "M"}}},
                {"data", {{"cov", kCov}}},
                {"damage",
                 {{"kind", "substructure"},
                  {"count", {{"min", 0}, {"max", 1}}},
                  {"reduction", {{"uniform", {0.0, 0.8}}}}}}};
};

// Probabilities of no damage, of one damage and of its place, by summation over all damages.
TEST_F(SubstructureDamage, PosteriorIsTheSumOverAllThereIs) {
  std::vector<double> measured = frequencies({1.0, 0.93, 1.0}, 4);
  const double noise[] = {0.004, -0.003, 0.002, 0.005};
  for (std::size_t i = 0; i < 4; ++i) measured[i] *= 1.0 + noise[i];
  given["data"]["frequencies"] = measured;

  const auto likelihood = [&](const std::vector<double>& remaining) {
    const auto f = frequencies(remaining, 4);
    double chi = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      chi += std::pow((measured[i] - f[i]) / (kCov * measured[i]), 2.0);
    return std::exp(-0.5 * chi);
  };
  const double none = likelihood({1.0, 1.0, 1.0});
  std::vector<double> at(3, 0.0);
  constexpr int kSteps = 2000;
  double reduction = 0.0, one = 0.0;
  for (std::size_t part = 0; part < 3; ++part)
    for (int i = 0; i < kSteps; ++i) {
      const double r = 0.8 * (i + 0.5) / kSteps;
      std::vector<double> remaining(3, 1.0);
      remaining[part] = 1.0 - r;
      const double p = likelihood(remaining) / kSteps / 3.0;
      at[part] += p;
      one += p;
      reduction += r * p;
    }
  const double exact = one / (none + one);
  ASSERT_GT(exact, 0.1);
  ASSERT_LT(exact, 0.98);

  const json s = run(given, "run");
  EXPECT_TRUE(s["diagnostics"]["converged"]);
  const double p = s["models"][1]["probability"].get<double>(),
               mcse = s["models"][1]["mcse"].get<double>();
  EXPECT_NEAR(p, exact, 4.0 * mcse);
  EXPECT_LT(mcse, 0.01);
  for (std::size_t part = 0; part < 3; ++part)
    EXPECT_NEAR(s["damage"]["inclusion_by_member"][kNames[part]].get<double>(),
                at[part] / (none + one), 0.02)
        << kNames[part];
  const json& found = s["parameters"]["1 soft substructure"]["reduction[1]"];
  EXPECT_NEAR(found["mean"].get<double>(), reduction / one,
              5.0 * found["sd"].get<double>() / std::sqrt(found["ess_bulk"].get<double>()));
}

TEST_F(SubstructureDamage, OfATruthIsSimulatedAndFound) {
  given["data"] = {{"cov", 0.001}, {"modes", 5}};
  given["damage"]["count"]["max"] = 2;
  given["damage"]["truth"] = {{{"substructure", "middle"}, {"reduction", 0.3}}};
  const std::string brief = "--warmup 1000 --draws 1000";
  const json s = run(given, "run", brief);
  EXPECT_TRUE(s["data"]["simulated"]);
  EXPECT_GT(s["damage"]["inclusion_by_member"]["middle"].get<double>(), 0.99);
  EXPECT_NEAR(s["parameters"]["1 soft substructure"]["reduction[1]"]["mean"].get<double>(), 0.3,
              0.01);
  EXPECT_EQ(s["parameters"]["1 soft substructure"]["substructure[1]"]["q50"], 1.0);

  const std::string made = (where / "made.json").string();
  ASSERT_EQ(wheeltap(where, "simulate " + (where / "run.json").string() + " -o " + made).exit_code,
            0);
  const json again = run(json::parse(read_all(made)), "again", brief);
  EXPECT_EQ(again["models"], s["models"]);
}

// Damage with an unknown scale, and a measurement of the healthy structure.
TEST_F(SubstructureDamage, BesideAnUnknownScale) {
  given["structure"]["change"] = {{"lower", "a"}, {"middle", "a"}, {"upper", "a"}};
  given["parameters"] = {{"a", {{"truncated_normal", {0.0, 0.1, -0.5, 0.5}}}}};
  const double stiffer = std::sqrt(1.06);
  std::vector<double> healthy = frequencies({1.0, 1.0, 1.0}, 5),
                      damaged = frequencies({1.0, 1.0, 0.6}, 5);
  for (double& f : healthy) f *= stiffer;
  for (double& f : damaged) f *= stiffer;
  given["baseline"] = {{"data", {{"frequencies", healthy}, {"cov", 0.002}}}};
  given["data"] = {{"frequencies", damaged}, {"cov", 0.002}};
  const json s = run(given, "run", "--warmup 2000 --draws 2000");
  EXPECT_GT(s["models"][1]["probability"], 0.99);
  EXPECT_GT(s["damage"]["inclusion_by_member"]["upper"].get<double>(), 0.99);
  const json& p = s["parameters"]["1 soft substructure"];
  EXPECT_NEAR(p["reduction[1]"]["mean"].get<double>(), 0.4, 0.03);
  EXPECT_NEAR(p["a"]["mean"].get<double>(), 0.06, 0.01);
  EXPECT_LT(s["baseline"]["check"]["largest_error"].get<double>(), 1e-5);
}

TEST_F(SubstructureDamage, Refusals) {
  given["data"]["frequencies"] = {2.0, 6.0};
  json bad = given;
  bad["damage"]["on"] = {"lower", "uper"};
  refused(bad,
          "/damage/on/1: \"uper\": there is no substructure of this name; did you mean \"upper\"?");
  bad = given;
  bad["damage"]["kind"] = "crack";
  refused(bad, "use \"substructure\" for \"matrices\"");
  bad = given;
  bad["structure"] = {
      {"chain",
       {{"masses", {1.0}}, {"links", {{{"name", "s"}, {"between", {0, 1}}, {"stiffness", 1e3}}}}}}};
  refused(bad, "a substructure is a part of \"matrices\"");
}

// Faults: a negative mass passed, a matrix that is listed twice counted twice, and of two degrees
// of freedom with the same name, only the first could be found.
TEST_F(SubstructureDamage, InvalidMatricesAreRefused) {
  given["data"]["frequencies"] = {2.0, 6.0};
  json bad = given;
  bad["structure"]["stiffness"]["upper"] = {"upper", "upper"};
  refused(bad,
          "/structure/stiffness/upper/1: \"upper\": this matrix is given in "
          "/structure/stiffness/upper/0 already");
  bad = given;
  bad["structure"]["stiffness"]["upper"] = "lower.mtx";
  refused(bad,
          "/structure/stiffness/upper: \"lower.mtx\": this matrix is given in "
          "/structure/stiffness/lower already");
  bad = given;
  bad["structure"]["dofs"] = "dofs.csv";
  where.write("dofs.csv", "number,place,direction\n1,n2,x\n2,n2,y\n3,n3,x\n4,n2,x\n");
  refused(bad, "line 5: place \"n2\" with direction \"x\" is listed in line 2 already");
  where.write("model/M.mtx", header(2) + entry(1, 1, kMass) + entry(2, 2, -kMass));
  refused(given,
          "/structure/mass: \"M\": the mass matrix has a negative mass: entry (2, 2) = -1000");
}

// Simulated modes are validated like measured modes; messages show their values.
TEST_F(SubstructureDamage, RefusesModesOfATruthThatMakeNoSense) {
  given["damage"]["truth"] = {{{"substructure", "middle"}, {"reduction", 0.3}}};
  given["data"] = {{"modes", 3}};
  refused(given, "/data/cov: 0.0: must be > 0 (0.01 is 1 % of each frequency)");
  given["data"] = {{"modes", 3}, {"cov", 0.9}, {"seed", 5}};
  refused(given, "/data/frequencies/2: -0.74");
  given["data"] = {{"modes", 3}, {"cov", 0.9}, {"seed", 3}};
  refused(given, "without shapes, frequencies must increase");
  given["data"] = {{"modes", 3}, {"cov", 0.002}, {"sensors", {{{"dof", 1}}, {{"dof", 3}}}}};
  refused(given, "/data/shape_sd: 0.0: must be > 0");
  given["data"] = {{"modes", 3}, {"cov", 0.002}, {"sensors", {{{"dof", 1}}}}, {"shape_sd", 0.01}};
  refused(given, "/data/shapes/0: [1.0");
}

}  // namespace
}  // namespace wheeltap::apps
