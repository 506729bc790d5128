// `wheeltap simulate` for monitored years, and `wheeltap monitor` with a structure.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class MonitoredStructure : public testing::Test {
 protected:
  [[nodiscard]] static json a_case() {
    return json::parse(R"({"kind": "monitor", "title": "Bridge",
      "series": {"file": "series.csv", "time": "hour",
                 "features": ["f1", "f2", "f3", "f4"], "covariates": ["air"]},
      "learning": {"until": 1000, "hinges": 0, "lag": false},
      "alarm": {"false_alarms_per_year": 1},
      "beam": {"length": 30, "elements": 15,
               "supports": [{"at": 0, "fix": ["deflection"]}, {"at": 12, "fix": ["deflection"]},
                            {"at": 30, "fix": ["deflection"]}],
               "material": {"young": 30e9, "poisson": 0.2, "density": 2500},
               "section": {"shape": "rectangle", "width": 1, "height": 0.6}},
      "damage": {"kind": "reduction", "count": {"max": 1}, "location": {"uniform": [0, 30]},
                 "reduction": {"uniform": [0, 0.8]},
                 "truth": [{"location": 21, "reduction": 0.4}]},
      "truth": {"rows": 340, "interval_hours": 4, "frost": {"per_degree": 0}, "noise": 0.001,
                "drift": {"sd": 0.0005},
                "changes": [{"hour": 1100, "damage": true}]}})");
  }
  [[nodiscard]] Outcome simulate(const json& c, const std::string& options = "") const {
    return wheeltap(where, "simulate " + where.write_json("case.json", c).string() + " -o " +
                               (where / "series.csv").string() + " " + options);
  }
  [[nodiscard]] json monitored(const json& c) const {
    const Outcome made = simulate(c);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    const Outcome ran = wheeltap(where, "monitor " + where.write_json("case.json", c).string() +
                                            " -o " + (where / "out").string() + " --quiet");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(where / "out/summary.json"));
  }
  void expect_refused(const json& c, const std::string& text) const {
    const Outcome ran = simulate(c);
    EXPECT_EQ(ran.exit_code, 65) << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(text));
  }
  Workspace where;
};

TEST_F(MonitoredStructure, SimulatesTheTableOfItsCase) {
  json c = a_case();
  ASSERT_EQ(simulate(c).exit_code, 0);
  const std::string table = read_all(where / "series.csv");
  EXPECT_THAT(table, testing::StartsWith("hour,f1,f2,f3,f4,air\n0,"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 341);
  ASSERT_EQ(simulate(c, "--seed 2").exit_code, 0);
  EXPECT_NE(read_all(where / "series.csv"), table);
  // Damage lowers frequencies from its instant on and changes no row before it.
  c["truth"]["changes"] = json::array();
  ASSERT_EQ(simulate(c).exit_code, 0);
  const std::string intact = read_all(where / "series.csv");
  const auto changed = std::ranges::mismatch(table, intact).in1 - table.begin();
  EXPECT_EQ(table.substr(table.rfind('\n', static_cast<std::size_t>(changed)) + 1, 5), "1100,");
  c["truth"]["start"] = "2026-01-01T00:00Z";
  ASSERT_EQ(simulate(c).exit_code, 0);
  EXPECT_THAT(read_all(where / "series.csv"), HasSubstr("\n2026-01-01 04:00:00"));
}

TEST_F(MonitoredStructure, ExplainsAChangeByDamageAtItsPlace) {
  const json s = monitored(a_case());
  ASSERT_TRUE(s["monitor"]["alarm"].get<bool>());
  const json& e = s["monitor"]["alarms"][0]["explanation"];
  EXPECT_NEAR(e["probability_damage"].get<double>() + e["probability_added_mass"].get<double>() +
                  e["probability_sensor_fault"].get<double>() +
                  e["probability_other"].get<double>(),
              1.0, 1e-9);
  EXPECT_GT(e["probability_damage"].get<double>(), 0.5);
  EXPECT_LT(e["sds_from_damage"].get<double>(), 4.0);
  const json& damage = e["defects"][0];
  EXPECT_TRUE(damage["is_damage"].get<bool>());
  EXPECT_LE(damage["severity"]["q5"].get<double>(), 0.5);
  EXPECT_GE(damage["severity"]["q95"].get<double>(), 0.3);
  EXPECT_FALSE(e["defects"][1]["is_damage"].get<bool>());
  EXPECT_EQ(s["damage"]["inclusion_by_element"]["overall"].size(), 15);
  EXPECT_THAT(read_all(where / "out/report.html"), HasSubstr("Causes"));
}

TEST_F(MonitoredStructure, ExplainsAStepOfOneFeatureByASensorFault) {
  json c = a_case();
  c["truth"]["changes"] = {{{"hour", 1100}, {"features", {{"f2", 0.01}}}}};
  const json s = monitored(c);
  ASSERT_TRUE(s["monitor"]["alarm"].get<bool>());
  const json& e = s["monitor"]["alarms"][0]["explanation"];
  EXPECT_LT(e["probability_damage"].get<double>(), 0.05);
  EXPECT_GT(e["sensor_faults"][1]["probability"].get<double>(), 0.5);
}

TEST_F(MonitoredStructure, NamesWhatIsWrong) {
  json c = a_case();
  c["truth"]["changes"][0]["features"] = {{"f1", 0.1}};
  expect_refused(c, "/truth/changes/0");
  c = a_case();
  c["truth"]["changes"] = {{{"hour", 10}, {"features", {{"f9", 0.1}}}}};
  expect_refused(c, "/truth/changes/0/features/f9");
  c = a_case();
  c.erase("truth");
  expect_refused(c, "/truth");
  c = a_case();
  c["damage"].erase("truth");
  expect_refused(c, "has no \"truth\"");
  c = a_case();
  c["truth"]["noise"] = {0.1, 0.1};
  expect_refused(c, "a list of 4 numbers");
  c = a_case();
  c.erase("damage");
  expect_refused(c, "/damage");
  c = a_case();
  c["explanation"]["modes"] = {1, 2, 2, 3};
  expect_refused(c, "/explanation/modes/2");
  c = a_case();
  c["beam"]["length"] = -1;
  expect_refused(c, "/beam/length");
  c = a_case();
  c.erase("beam");
  expect_refused(c, "needs the monitored structure");
}

}  // namespace
}  // namespace wheeltap::apps
