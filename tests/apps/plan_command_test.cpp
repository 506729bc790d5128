// `wheeltap plan`, as its users run it.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class PlanCommand : public testing::Test {
 protected:
  /// A symmetric beam with ten candidate sensors.
  [[nodiscard]] static json a_case() {
    return json::parse(R"({"kind": "damage", "title": "Beam",
      "beam": {"length": 1.0, "elements": 20, "supports": "simply-supported",
               "material": {"young": 70e9, "poisson": 0.3, "density": 2700},
               "section": {"shape": "rectangle", "width": 0.025, "height": 0.006}},
      "damage": {"count": {"min": 0, "max": 1, "prior": "uniform"},
                 "location": {"uniform": [0, 1]}, "reduction": {"uniform": [0, 0.6]}},
      "plan": {"sensors": [{"every": 0.1}], "choose": 2, "modes": 4, "seconds": 3600,
               "damping": 0.002, "shape_sd": 0.01, "false_alarm": 0.05, "tolerance": 0.1,
               "masses": [{"at": 0.5, "mass": 0.05}, {"at": 0.3, "mass": 0.05}]}})");
  }
  [[nodiscard]] Outcome run(const json& c, const std::string& folder,
                            const std::string& options = "") const {
    return wheeltap(where, "plan " + where.write_json("case.json", c).string() + " -o " +
                               (where / folder).string() +
                               " --quiet --scenarios 1000 --check 0 --seed 3 " + options);
  }
  [[nodiscard]] json plan(const std::string& folder) const {
    return json::parse(read_all(where / (folder + "/summary.json"))).at("plan");
  }
  void expect_refused(const json& c, const std::string& text) const {
    const Outcome ran = run(c, "refused");
    EXPECT_EQ(ran.exit_code, 65) << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(text));
    EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
  }
  Workspace where;
};

// Before: "/data: is missing: must be an object".
TEST_F(PlanCommand, TheDamageCommandNamesThePlanCommand) {
  const Outcome ran = wheeltap(where, "damage " + where.write_json("case.json", a_case()).string() +
                                          " -o " + (where / "out").string());
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("/data: is missing: this case plans a test. Run wheeltap plan"));
}

// Before: a plan with unknown coefficients was refused.
TEST_F(PlanCommand, AnUnknownModulusMakesDamageHarderToDetect) {
  json c = a_case();
  c["plan"].erase("masses");
  c["plan"]["modes"] = 2;
  ASSERT_EQ(run(c, "known").exit_code, 0);
  c["beam"]["material"]["young"] = "E";
  c["parameters"] = {{"E", {{"log_normal", {24.97, 0.03}}}}};
  const Outcome ran = run(c, "unknown");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto alone = [&](const char* folder) {
    return plan(folder).at("frequencies_alone").at("information").get<double>();
  };
  EXPECT_LT(alone("unknown"), alone("known") - 0.1);
  EXPECT_LT(plan("unknown").at("unknown_coefficients").at("q90").get<double>(), 0.5);
  // Before: damage.json had a truth, from which no command simulates unknown coefficients.
  const json rehearsal = json::parse(read_all(where / "unknown/damage.json"));
  EXPECT_FALSE(rehearsal.at("damage").contains("truth"));
  EXPECT_EQ(rehearsal.at("data").at("from"), "modes.json");
}

// Before: "cov" and "shape_sd" were single numbers.
TEST_F(PlanCommand, ModesMayHaveTheirOwnNoise) {
  json c = a_case();
  c["plan"].erase("seconds");
  c["plan"].erase("damping");
  c["plan"]["cov"] = {0.001, 0.002};
  c["plan"]["shape_sd"] = {0.001, 0.01};
  ASSERT_EQ(run(c, "out").exit_code, 0);
  EXPECT_EQ(plan("out").at("frequency_cov"), json::parse("[0.001, 0.002, 0.002, 0.002]"));
}

// Before: the layout with all candidates was compared with itself, under seven names.
TEST_F(PlanCommand, AllCandidatesLeaveNoOtherLayout) {
  json c = a_case();
  c["plan"]["sensors"] = {{{"every", 0.34}}};
  const Outcome ran = run(c, "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_TRUE(plan("out").at("others").empty());
  EXPECT_EQ(plan("out").at("designs").size(), 1u);
}

TEST_F(PlanCommand, RecommendsSensorsAndWritesTheirDamageCase) {
  const Outcome ran = run(a_case(), "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("effective independence"));
  const json p = plan("out");
  ASSERT_FALSE(p.at("designs").empty());
  double before = 1e9;
  for (const json& d : p.at("designs")) {
    EXPECT_EQ(d.at("sensors").size(), 2u);
    EXPECT_LE(d.at("right_place").get<double>(), before);
    before = d.at("right_place").get<double>();
    for (const char* key : {"detection", "right_place"}) {
      EXPECT_GE(d.at(key).get<double>(), 0.0);
      EXPECT_LE(d.at(key).get<double>(), 1.0);
      EXPECT_GT(d.at("mcse").at(key).get<double>(), 0.0);
    }
    EXPECT_LE(d.at("right_place").get<double>(), d.at("detection").get<double>());
  }
  // All 36 layouts are compared.
  EXPECT_TRUE(p.at("search").at("exhaustive").get<bool>());
  EXPECT_EQ(p.at("smallest_detectable").size(), 20u);
  // A damage at a support changes nothing; one at midspan is found.
  EXPECT_TRUE(p.at("smallest_detectable")[10].at("reduction").is_number());
  // The recommended case runs, and its data are those of the design.
  const json damage = json::parse(read_all(where / "out/damage.json"));
  EXPECT_EQ(damage.at("data").at("sensors").size(), 2u);
  const Outcome modes =
      wheeltap(where, "modes " + (where / "out/damage.json").string() + " --truth");
  EXPECT_EQ(modes.exit_code, 0) << modes.err;
  const Outcome again = wheeltap(where, "damage " + (where / "out/damage.json").string() + " -o " +
                                            (where / "again").string() + " --dry-run");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(read_all(where / "out/report.html"), HasSubstr("Recommended design"));
}

TEST_F(PlanCommand, SaysWhichTestDistinguishesMirrorImages) {
  ASSERT_EQ(run(a_case(), "out").exit_code, 0);
  const json alone = plan("out").at("alone");
  ASSERT_FALSE(alone.at("indistinguishable").empty());
  EXPECT_TRUE(alone.at("indistinguishable")[0].at("exact").get<bool>());
  // The smallest set has two sensors, since shapes have no scale.
  EXPECT_EQ(alone.at("separation").at("sensors").at("sensors").size(), 2u);
  // The mass on the axis of symmetry separates nothing: the one off the axis is named.
  EXPECT_THAT(alone.at("separation").at("mass").at("mass").get<std::string>(), HasSubstr("0.3 m"));
  json c = a_case();
  c["plan"]["masses"].erase(1);
  ASSERT_EQ(run(c, "centre").exit_code, 0);
  EXPECT_TRUE(plan("centre").at("alone").at("separation").at("mass").is_null());
}

TEST_F(PlanCommand, DrawsThePageAgainAndRepeatsItsNumbers) {
  ASSERT_EQ(run(a_case(), "out", "--threads 1").exit_code, 0);
  ASSERT_EQ(run(a_case(), "again", "--threads 2").exit_code, 0);
  EXPECT_EQ(plan("out"), plan("again"));
  const std::string page = read_all(where / "out/report.html");
  ASSERT_EQ(wheeltap(where, "report " + (where / "out").string()).exit_code, 0);
  EXPECT_EQ(read_all(where / "out/report.html"), page);
}

TEST_F(PlanCommand, MoreCostlyTestsMustPay) {
  json c = a_case();
  c["plan"]["costs"] = {{"sensor", 10}, {"inspection", 100}, {"missed_damage", 10000}};
  ASSERT_EQ(run(c, "out").exit_code, 0);
  const json value = plan("out").at("value");
  ASSERT_FALSE(value.at("best").is_null());
  const json& best = value.at("options")[value.at("best").get<std::size_t>()];
  for (const json& o : value.at("options"))
    EXPECT_LE(o.at("saving").get<double>(), best.at("saving").get<double>());
  EXPECT_EQ(value.at("sensitivity").size(), 6u);  // half and twice each cost above zero
  // A sensor that costs more than any damage is never bought, and no test pays.
  c["plan"]["costs"]["sensor"] = 1e6;
  c["plan"]["costs"]["hour"] = 1e6;
  ASSERT_EQ(run(c, "costly").exit_code, 0);
  EXPECT_TRUE(plan("costly").at("value").at("best").is_null());
}

TEST_F(PlanCommand, WrongInputEndsWithItsPlaceAndValue) {
  const auto with = [](const char* where_in_case, const json& value) {
    json c = a_case();
    c[json::json_pointer(where_in_case)] = value;
    return c;
  };
  expect_refused(with("/plan/choose", 1),
                 "/plan/choose: 1: one sensor cannot measure a mode shape");
  expect_refused(with("/plan/choose", 12), "/plan/choose: 12: must be at most");
  expect_refused(with("/plan/band", json::array({5, 2})), "/plan/band");
  expect_refused(with("/plan/band", json::array({1, 2})),
                 "/plan/band: [1,2]: the structure has no mode");
  expect_refused(with("/plan/cov", 0.001), "/plan/cov");
  expect_refused(with("/plan/shape_sd", -1), "/plan/shape_sd: -1");
  expect_refused(with("/plan/sensors/0", {{"at", 1.5}}), "/plan/sensors/0/at: 1.5");
  expect_refused(with("/plan/sensors/0", {{"every", 2}}), "/plan/sensors/0/every: 2");
  expect_refused(with("/plan/masses/0", {{"at", 3}, {"mass", 1}}), "/plan/masses/0");
  expect_refused(with("/plan/masses/0", {{"at", 0.31}, {"mass", 1}}), "/plan/masses/0/at");
  expect_refused(with("/plan/masses/0", {{"at", 0.5}, {"mass", 1e13}}), "/plan/masses/0/mass");
  expect_refused(with("/plan/layouts", json::parse("[[0, 99]]")), "/plan/layouts/0/1: 99");
  expect_refused(with("/damage/count/max", 3), "/damage/count");
  expect_refused(with("/damage/count/min", 1), "/damage/count");
  expect_refused(with("/damage/count", json::parse(R"({"max": 1, "prior": [1, 0]})")),
                 "prior probability of at least one defect");
  expect_refused(with("/plan/false_alarm", 0.0005), "/plan/false_alarm: 0.0005: must be at least");
  expect_refused(with("/plan/costs", {{"inspection", 5}, {"missed_damage", 1}}),
                 "/plan/costs/missed_damage: 1: must exceed");
  expect_refused(with("/plan/costs", {{"inspection", -5}, {"missed_damage", 1}}),
                 "/plan/costs/inspection: -5");
  expect_refused(
      with("/beam/material/young", "E")
          .patch(json::parse(
              R"([{"op": "add", "path": "/parameters", "value": {"E": {"log_normal": [25, 0.05]}}}])")),
      "/plan/masses: ");
  expect_refused(with("/plan/false_alarm", 0.005),
                 "/plan/false_alarm: 0.005: is too small for 1 000 simulated tests: use "
                 "--scenarios 20000 or more");
  expect_refused(with("/plan/seconds", 1e-4), "/plan/seconds: 0.0001: gives a standard deviation");
  json one_place = with("/damage/location", {{"uniform", {0.01, 0.04}}});
  one_place["damage"]["count"]["max"] = 2;
  expect_refused(one_place, "/damage/count");
  json no_length = with("/plan/costs", {{"hour", 5}, {"inspection", 1}, {"missed_damage", 9}});
  no_length["plan"]["cov"] = 0.001;
  for (const char* key : {"seconds", "damping"}) no_length["plan"].erase(key);
  expect_refused(no_length, "/plan/seconds: is missing");
  json none = a_case();
  none.erase("plan");
  expect_refused(none, "/plan: is missing");
}

}  // namespace
}  // namespace wheeltap::apps
