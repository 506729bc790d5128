// Stiffness loss of groups of members: cases with substructures of members.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kCov = 0.004;
// In the order of the keys of a case.
const std::vector<std::string> kGroups = {"beams", "lower columns", "upper columns"};

/// A frame of two storeys with one steel per group and the remaining fraction of E of each. The
/// upper storey has a smaller height, so that no groups are equivalent.
json grouped_frame(const std::vector<double>& remaining = {1.0, 1.0, 1.0}) {
  json materials = json::object(), members = json::array();
  for (std::size_t g = 0; g < kGroups.size(); ++g)
    materials[kGroups[g]] = {
        {"young", 210e9 * remaining[g]}, {"poisson", 0.3}, {"density", 7850.0}};
  const auto add = [&](const std::string& name, const std::string& a, const std::string& b,
                       const std::string& group) {
    members.push_back({{"name", name},
                       {"nodes", {a, b}},
                       {"elements", 3},
                       {"material", group},
                       {"section", "bar"}});
  };
  add("a1", "A", "B", "lower columns"), add("b1", "D", "E", "lower columns");
  add("a2", "B", "C", "upper columns"), add("b2", "E", "F", "upper columns");
  add("floor", "B", "E", "beams"), add("roof", "C", "F", "beams");
  return {{"dimension", 2},
          {"materials", materials},
          {"sections", {{"bar", {{"shape", "rectangle"}, {"width", 0.05}, {"height", 0.02}}}}},
          {"nodes",
           {{"A", {0, 0}},
            {"B", {0, 1.2}},
            {"C", {0, 2}},
            {"D", {1.5, 0}},
            {"E", {1.5, 1.2}},
            {"F", {1.5, 2}}}},
          {"members", members},
          {"supports",
           {{{"node", "A"}, {"fix", {"x", "y", "rotation"}}},
            {{"node", "D"}, {"fix", {"x", "y", "rotation"}}}}}};
}

std::vector<double> frequencies_of(const std::vector<double>& remaining, int modes) {
  return frequencies(members_of({{"kind", "damage"}, {"structure", grouped_frame(remaining)}}),
                     modes);
}

class MemberGroups : public testing::Test {
 protected:
  [[nodiscard]] json run(const std::string& options) const {
    const Outcome ran =
        wheeltap(where, "damage " + where.write_json("case.json", given).string() + " -o " +
                            (where / "run").string() + " --quiet " + options);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(where / "run" / "summary.json"));
  }
  void refused(const json& one, const std::string& words) const {
    const Outcome ran = wheeltap(where, "damage " + where.write_json("bad.json", one).string() +
                                            " -o " + (where / "bad").string());
    EXPECT_EQ(ran.exit_code, 65) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(words));
  }
  Workspace where;
  json given = {{"kind", "damage"},
                {"structure", grouped_frame()},
                {"data", {{"cov", kCov}}},
                {"damage",
                 {{"kind", "substructure"},
                  {"groups",
                   {{"lower columns", {"a1", "b1"}},
                    {"upper columns", {"a2", "b2"}},
                    {"beams", {"floor", "roof"}}}},
                  {"count", {{"min", 0}, {"max", 1}}},
                  {"reduction", {{"uniform", {0.0, 0.8}}}}}}};
};

// Comparison with the sum over all damages, from structures with softer steel.
TEST_F(MemberGroups, PosteriorIsTheSumOverAllThereIs) {
  constexpr int kModes = 5, kSteps = 400;
  std::vector<double> measured = frequencies_of({1.0, 1.0, 0.955}, kModes);
  const double noise[kModes] = {0.004, -0.003, 0.002, 0.005, -0.001};
  for (std::size_t i = 0; i < kModes; ++i) measured[i] *= 1.0 + noise[i];
  given["data"]["frequencies"] = measured;
  const auto likelihood = [&](const std::vector<double>& remaining) {
    const auto f = frequencies_of(remaining, kModes);
    double chi = 0.0;
    for (std::size_t i = 0; i < kModes; ++i)
      chi += std::pow((measured[i] - f[i]) / (kCov * measured[i]), 2.0);
    return std::exp(-0.5 * chi);
  };
  const double none = likelihood({1.0, 1.0, 1.0});
  std::vector<double> at(3, 0.0);
  double one = 0.0;
  for (std::size_t g = 0; g < 3; ++g)
    for (int i = 0; i < kSteps; ++i) {
      std::vector<double> remaining(3, 1.0);
      remaining[g] = 1.0 - 0.8 * (i + 0.5) / kSteps;
      const double p = likelihood(remaining) / kSteps / 3.0;
      at[g] += p;
      one += p;
    }
  const double exact = one / (none + one);
  ASSERT_GT(exact, 0.1);
  ASSERT_LT(exact, 0.98);

  const json s = run("");
  EXPECT_TRUE(s["diagnostics"]["converged"]);
  const double p = s["models"][1]["probability"].get<double>(),
               mcse = s["models"][1]["mcse"].get<double>();
  EXPECT_NEAR(p, exact, 4.0 * mcse);
  EXPECT_LT(mcse, 0.01);
  for (std::size_t g = 0; g < 3; ++g)
    EXPECT_NEAR(s["damage"]["inclusion_by_member"][kGroups[g]].get<double>(), at[g] / (none + one),
                0.02)
        << kGroups[g];
}

TEST_F(MemberGroups, OfATruthIsSimulatedAndFound) {
  given["data"] = {{"cov", 0.001}, {"modes", 6}};
  given["damage"]["truth"] = {{{"substructure", "upper columns"}, {"reduction", 0.3}}};
  const json s = run("--warmup 1000 --draws 1000");
  EXPECT_GT(s["damage"]["inclusion_by_member"]["upper columns"].get<double>(), 0.99);
  const json& found = s["parameters"]["1 soft substructure"];
  EXPECT_NEAR(found["reduction[1]"]["mean"].get<double>(), 0.3, 0.02);
  EXPECT_EQ(found["substructure[1]"]["q50"], 2.0);
  // The frame and every group are symmetric.
  EXPECT_FALSE(s["diagnostics"].contains("symmetry"));
  EXPECT_EQ(s["structure"]["lines"]["soft substructure"]["stretches"][2]["members"], json({2, 3}));
}

// A symmetric frame: left and right columns are mirror images.
TEST_F(MemberGroups, ImagesOfGroupsAreFound) {
  given["data"] = {{"cov", 0.002}, {"modes", 5}};
  given["damage"]["groups"] = {{"left", {"a1", "a2"}}, {"right", {"b2", "b1"}}};
  given["damage"]["truth"] = {{{"substructure", "left"}, {"reduction", 0.3}}};
  const json s = run("--warmup 1000 --draws 2000");
  EXPECT_EQ(s["diagnostics"]["symmetry"]["alike"], json::parse(R"([["left", "right"]])"));
  EXPECT_NEAR(s["damage"]["inclusion_by_member"]["left"].get<double>(), 0.5, 0.1);
  // Both are reported, although there are few.
  ASSERT_EQ(s["damage"]["places"]["soft substructure"].size(), 2U);
  for (const json& place : s["damage"]["places"]["soft substructure"])
    EXPECT_NEAR(place["reduction"]["q50"].get<double>(), 0.3, 0.05) << place;
}

// The truth gives the number of modes and their noise, so that a case needs no data.
TEST_F(MemberGroups, DataAreSimulatedWhereThereAreNone) {
  given.erase("data");
  given["damage"]["truth"] = {
      {"defects", json::array({{{"substructure", "beams"}, {"reduction", 0.2}}})},
      {"modes", 4},
      {"cov", 0.001}};
  const std::string path = where.write_json("case.json", given).string();
  const std::string made = (where / "made.json").string();
  const Outcome ran = wheeltap(where, "simulate " + path + " -o " + made);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(json::parse(read_all(made))["data"]["frequencies"].size(), 4U);
  const std::string before = read_all(path);
  const Outcome onto_itself = wheeltap(where, "simulate " + path + " -o " + path);
  EXPECT_EQ(onto_itself.exit_code, 64);
  EXPECT_THAT(onto_itself.err, HasSubstr("is the case itself"));
  EXPECT_EQ(read_all(path), before);
}

TEST_F(MemberGroups, Refusals) {
  given["data"]["frequencies"] = {10.0, 20.0};
  json bad = given;
  bad["damage"].erase("groups");
  refused(bad, "/damage/groups: is missing: must be an object that maps each substructure");
  bad = given;
  bad["damage"]["groups"]["beams"] = {"floor", "rof"};
  refused(
      bad,
      "/damage/groups/beams/1: \"rof\": there is no member of this name; did you mean \"roof\"?");
  bad = given;
  bad["damage"]["groups"]["beams"] = {"floor", "floor"};
  refused(bad, "/damage/groups/beams/1: \"floor\": is in this substructure already");
  bad = given;
  bad["damage"]["groups"]["again"] = {"roof", "floor"};
  refused(bad, "/damage/groups/beams: [\"floor\",\"roof\"]: has the same members as another");
  bad = given;
  bad["damage"]["kind"] = "crack";
  bad["damage"]["depth"] = {{"uniform", {0.0, 0.5}}};
  bad["damage"].erase("reduction");
  refused(bad, "/damage/groups: is allowed with \"kind\": \"substructure\" only");
  bad = given;
  bad["damage"]["on"] = {"beam"};
  refused(bad, "there is no substructure of this name; did you mean \"beams\"?");
}

}  // namespace
}  // namespace wheeltap::apps
