#include "apps/cases/damage_case.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "fem/sections/section.hpp"
#include "identification/emulation/interpolants.hpp"
#include "program.hpp"

namespace wheeltap::apps::damage_case_test {

using namespace identification;

namespace {

using testing::HasSubstr;

DamageCase parsed(const Json& json, Needs needs = Needs::data) {
  const Workspace where;
  return parse_damage_case(read_case(where.write_json("c.json", json)), needs).damage;
}

std::string complaint(const Json& json) {
  try {
    (void)parsed(json);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos) << "one line";
    return failure.what();
  }
  return "";
}

TEST(DamageCase, ReadsTheContractsExample) {
  const DamageCase c = parsed(small_case());
  EXPECT_EQ(c.title, "A small case");
  EXPECT_EQ(c.beam.elements, 10);
  EXPECT_NEAR(c.beam.section.area, 0.00015, 1e-18);
  EXPECT_DOUBLE_EQ(c.beam.section.shear_coefficient, fem::cowper_rectangle(0.3));
  ASSERT_EQ(c.kinds.size(), 1U);
  EXPECT_EQ(c.kinds[0].plural, "damages");
  EXPECT_EQ(c.kinds[0].weights, std::vector<double>(3, 1.0 / 3.0));
  EXPECT_DOUBLE_EQ(c.data.sd_hz[1], 0.553);
  EXPECT_FALSE(c.emulator);
}

TEST(DamageCase, BalanceIsAskedFor) {
  Json json = small_case();
  EXPECT_FALSE(parsed(json).balance);
  json["balance"] = true;
  EXPECT_TRUE(parsed(json).balance);
  json["balance"] = 1;
  EXPECT_THAT(complaint(json), HasSubstr("/balance"));
}

TEST(DamageCase, CountPriors) {
  Json json = small_case();
  json["damage"]["count"] = {{"min", 1}, {"max", 3}, {"prior", {{"poisson", 2.0}}}};
  const auto poisson = parsed(json).kinds[0].weights;  // ∝ 2, 2, 4/3
  EXPECT_NEAR(poisson[0], 0.375, 1e-12);
  EXPECT_NEAR(poisson[2], 0.25, 1e-12);
  json["damage"]["count"]["prior"] = {1, 0, 3};
  EXPECT_EQ(parsed(json).kinds[0].weights, (std::vector<double>{0.25, 0.0, 0.75}));
  json["damage"]["count"]["prior"] = {1, 2};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/count/prior: [1,2]: must have 3 weights"));
  json["damage"]["count"]["prior"] = {0, 0, 0};
  EXPECT_THAT(complaint(json), HasSubstr("at least one weight"));
  json["damage"]["count"] = {{"min", 3}, {"max", 2}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/count/min: 3: must not exceed max"));
}

// The schema contains the types of defect of the list, and the keys of their severities.
TEST(DamageCase, EveryTypeOfDefectIsInTheSchema) {
  const Json rules = schema("damage")["definitions"];
  for (const auto* type : identification::defect_types()) {
    if (!type->is_for_beams()) continue;
    EXPECT_THAT(rules["defects"]["properties"]["kind"]["enum"],
                testing::Contains(std::string(type->name)));
    EXPECT_TRUE(rules["defects"]["properties"].contains(std::string(type->severity)));
    EXPECT_TRUE(rules["true_defect"]["properties"].contains(std::string(type->severity)));
  }
}

TEST(DamageCase, SectionsByShape) {
  Json json = small_case();
  const auto section = [&](const char* text) {
    json["beam"]["section"] = Json::parse(text);
    return parsed(json).beam.section;
  };
  EXPECT_NEAR(section(R"({"shape": "circle", "diameter": 0.02})").area, M_PI * 1e-4, 1e-12);
  EXPECT_NEAR(section(R"({"shape": "tube", "outer_diameter": 0.02, "thickness": 0.002})").area,
              M_PI * (1e-4 - 0.64e-4), 1e-12);
  EXPECT_NEAR(section(R"({"shape": "box", "height": 0.02, "width": 0.01, "flange_thickness": 0.001,
                          "web_thickness": 0.001})")
                  .area,
              0.02 * 0.01 - 0.018 * 0.008, 1e-12);
  EXPECT_NEAR(section(R"({"shape": "i", "height": 0.02, "width": 0.01, "flange_thickness": 0.001,
                          "web_thickness": 0.002})")
                  .area,
              2 * 0.01 * 0.001 + 0.018 * 0.002, 1e-12);
  const auto explicit_section =
      section(R"({"area": 1e-4, "second_moment": 1e-9, "shear_coefficient": 0.8})");
  EXPECT_EQ(explicit_section.second_moment, 1e-9);
  EXPECT_EQ(explicit_section.shear_coefficient, 0.8);
  EXPECT_EQ(section(R"({"shape": "circle", "diameter": 0.02, "shear_coefficient": 0.9})")
                .shear_coefficient,
            0.9);
  json["beam"]["section"] = {{"shape", "circle"}, {"width", 0.01}, {"diameter", 0.01}};
  EXPECT_THAT(complaint(json), HasSubstr("/beam/section/width"));
  json["beam"]["section"] = {{"shape", "circle"}};
  EXPECT_THAT(complaint(json), HasSubstr("/beam/section/diameter: is missing"));
  json["beam"]["section"] = {{"shape", "tube"}, {"outer_diameter", 0.01}, {"thickness", 0.02}};
  EXPECT_THAT(complaint(json), HasSubstr("/beam/section"));
}

TEST(DamageCase, SupportsAsAList) {
  Json json = small_case();
  json["beam"]["supports"] = Json::parse(
      R"([{"at": 0, "fix": ["deflection", "rotation"]},
          {"at": 0.7, "fix": ["deflection"], "stiffness": 1e5}])");
  const auto supports = parsed(json).beam.supports;
  ASSERT_EQ(supports.size(), 2U);
  EXPECT_TRUE(supports[0].rotation);
  EXPECT_FALSE(supports[0].stiffness.has_value());
  EXPECT_EQ(supports[1].stiffness, 1e5);
  json["beam"]["supports"][1]["at"] = 1.2;
  EXPECT_THAT(complaint(json), HasSubstr("/beam/supports/1/at: 1.2: is outside"));
}

TEST(DamageCase, SeveralKinds) {
  Json json = small_case();
  Json support = {{"kind", "support"},
                  {"count", {{"max", 1}}},
                  {"location", {{"uniform", {0.0, 1.0}}}},
                  {"fix", {"rotation"}},
                  {"stiffness", {{"log_uniform", {1e2, 1e6}}}}};
  json["damage"] = {json["damage"], support};
  const auto kinds = parsed(json).kinds;
  ASSERT_EQ(kinds.size(), 2U);
  EXPECT_EQ(kinds[1].name, "support");
  EXPECT_TRUE(kinds[1].rotation);
  EXPECT_EQ(kinds[1].severity_prior()->lower(), 1e2);
  json["damage"][1]["reduction"] = {{"uniform", {0, 0.5}}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/1/reduction"));
  json["damage"][1] = json["damage"][0];
  EXPECT_THAT(complaint(json), HasSubstr("two kinds have the name \"damage\""));
}

TEST(DamageCase, PriorsMustStayWhereTheyMeanSomething) {
  Json json = small_case();
  json["damage"]["location"] = {{"uniform", {0.0, 1.5}}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/location"));
  EXPECT_THAT(complaint(json), HasSubstr("in [0, 1.0] m"));
  json = small_case();
  json["damage"]["reduction"] = {{"uniform", {0.0, 1.0}}};
  EXPECT_THAT(complaint(json), HasSubstr("[0, 1)"));
  json["damage"]["reduction"] = {{"normal", {0.3, 0.1}}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/reduction"));
  json["damage"]["reduction"] = {{"uniform", {0.6, 0.1}}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/reduction/uniform"));
}

TEST(DamageCase, NoiseAndMissingModes) {
  Json json = small_case();
  json["data"] = Json::parse(R"({"frequencies": [13.8, null, 124.0], "sd": [0.1, null, 1.0]})");
  const auto data = parsed(json).data;
  EXPECT_TRUE(std::isnan(data.frequencies_hz[1]));
  EXPECT_EQ(data.measured(), 2);
  json["data"]["sd"] = {0.1, 1.0};
  EXPECT_THAT(complaint(json), HasSubstr("/data/sd"));
  json["data"]["cov"] = 0.01;
  EXPECT_THAT(complaint(json), HasSubstr("either \"cov\" or \"sd\""));
  json["data"] = Json::parse(R"({"frequencies": [13.8, 12.0], "cv": 0.01})");
  EXPECT_THAT(complaint(json), HasSubstr("/data/frequencies/1: 12.0: frequencies must increase"));
  json["data"] = Json::parse(R"({"frequencies": [13.8]})");
  EXPECT_THAT(complaint(json), HasSubstr("/data/cov: is missing"));
  json["data"] = Json::parse(R"({"frequencies": [13.8], "cv": {"log_uniform": [1e-4, 0.1]}})");
  EXPECT_TRUE(parsed(json).data.cv_prior) << "cv is another name for cov";
  json["data"]["cov"] = 0.01;
  EXPECT_THAT(complaint(json), HasSubstr("is an alias of"));
}

TEST(DamageCase, MoreModesThanDegreesOfFreedom) {
  Json json = small_case();
  json["beam"]["elements"] = 2;  // 6 dofs, 2 fixed
  json["data"]["frequencies"] = {1, 2, 3, 4, 5};
  EXPECT_THAT(complaint(json), HasSubstr("5 modes: must be at most 4"));
  json["data"]["frequencies"] = {1, 2, 3, 4};
  EXPECT_EQ(complaint(json), "");
}

TEST(DamageCase, SimulatesFromItsTruth) {
  Json json = small_case();
  json["data"] = {{"cov", 1e-3}, {"modes", 4}, {"seed", 7}};
  json["damage"]["truth"] = {{{"location", 0.35}, {"reduction", 0.5}}};
  const DamageCase c = parsed(json);
  const auto exact = elastic_frequencies(c.beam, c.true_defects(), 4);
  const auto intact = elastic_frequencies(c.beam, {}, 4);
  ASSERT_EQ(c.data.modes(), 4);
  bool noisy = false;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(exact[i], intact[i]);
    EXPECT_NEAR(c.data.frequencies_hz[i], exact[i], 5e-3 * exact[i]);
    EXPECT_NEAR(c.data.sd_hz[i], 1e-3 * exact[i], 1e-15 * exact[i]);
    noisy = noisy || c.data.frequencies_hz[i] != exact[i];
  }
  EXPECT_TRUE(noisy);
  EXPECT_EQ(parsed(json).data.frequencies_hz, c.data.frequencies_hz) << "seeded";
  json["data"]["seed"] = 8;
  EXPECT_NE(parsed(json).data.frequencies_hz, c.data.frequencies_hz);
  json["damage"]["truth"] = Json{{"defects", json["damage"]["truth"]}, {"modes", 2}, {"seed", 9}};
  EXPECT_EQ(parsed(json).data.modes(), 2);
  json["damage"]["truth"] = {{{"location", 1.35}, {"reduction", 0.5}}};
  EXPECT_THAT(complaint(json), HasSubstr("/damage/truth/0/location: 1.35: is outside"));
  json["damage"]["truth"] = {{{"location", 0.35}, {"reduction", 1.0}}};
  EXPECT_THAT(complaint(json), HasSubstr("must be < 1"));
}

TEST(DamageCase, FreeFreeDataAreElastic) {
  Json json = small_case();
  json["beam"]["supports"] = "free-free";
  json["data"] = {{"cov", 1e-3}, {"modes", 3}};
  json["damage"]["truth"] = Json::array();
  const DamageCase c = parsed(json);
  EXPECT_EQ(c.rigid_body_modes, 2);
  EXPECT_GT(c.data.frequencies_hz[0], 1.0);
}

TEST(DamageCase, EmulatorDesigns) {
  Json json = small_case();
  json["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  json["predictor"] = Json::parse(R"({"sites": [[1, 5, 10], [2, 10]], "multipliers": [1, 0.4]})");
  const auto spec = *parsed(json).emulator;
  EXPECT_EQ(spec.sites, (std::vector<std::vector<int>>{{0, 4, 9}, {1, 9}}));
  EXPECT_EQ(spec.reductions, (std::vector<double>{0.0, 0.6}));
  json["predictor"]["sites"] = {1, 5, 5};
  EXPECT_THAT(complaint(json), HasSubstr("/predictor/sites/2: 5: sites must increase"));
  json["predictor"]["sites"] = {1, 11};
  EXPECT_THAT(complaint(json), HasSubstr("the beam has 10 elements"));
  json["predictor"] = {{"sites", {1, 5}}};
  EXPECT_THAT(complaint(json), HasSubstr("/predictor/multipliers: is missing"));
}

TEST(DamageCase, InterpolantsAreThoseOfTheList) {
  Json json = small_case();
  std::vector<std::string> names;
  for (const auto* type : interpolant_types()) {
    names.emplace_back(type->name);
    json["predictor"] = type->runs == emulator::InterpolantType::Runs::grid
                            ? Json::parse(R"({"sites": [1, 10], "multipliers": [1, 0.4]})")
                            : Json::parse(R"({"design": {"kind": "sobol", "runs": 20}})");
    json["predictor"]["interpolation"] = names.back();
    EXPECT_EQ(parsed(json).emulator->interpolant, type);
  }
  EXPECT_EQ(schema("damage").flatten().dump().find("x-list"), std::string::npos);
  json["predictor"] = Json::parse(R"({"sites": [1, 10], "multipliers": [1, 0.4]})");
  json["predictor"]["interpolation"] = "spline";
  for (const std::string& name : names) EXPECT_THAT(complaint(json), HasSubstr(name));
  json["predictor"]["interpolation"] = "gaussian-process";
  EXPECT_THAT(complaint(json), HasSubstr("\"multilinear\", \"cubic\" and \"monotone-cubic\""));

  // The check precedes the runs.
  json["damage"]["count"]["max"] = 4;
  json["predictor"]["interpolation"] = "cubic";
  EXPECT_THAT(complaint(json), HasSubstr("\"cubic\" supports up to 3 damages"));
  json["predictor"]["expansion"] = "anova";
  EXPECT_EQ(parsed(json).emulator->tables(4), 2);
}

TEST(DamageCase, SymmetricBeamsHaveSymmetricEmulators) {
  Json json = small_case();
  json["predictor"] = Json::parse(R"({"sites": [1, 10], "multipliers": [1, 0.4]})");
  EXPECT_TRUE(parsed(json).emulator->symmetrise);
  json["predictor"]["emulator_error"] = false;
  EXPECT_FALSE(parsed(json).emulator->symmetrise) << "trusted blindly, as it is";
}

}  // namespace
}  // namespace wheeltap::apps::damage_case_test
