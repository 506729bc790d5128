// `wheeltap monitor`, as its users run it.
#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "apps/cases/monitoring/monitor_simulation.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The starter's series, cut to its first rows.
class MonitorCommand : public testing::Test {
 protected:
  MonitorCommand() {
    std::istringstream all(simulated_series_csv(1));
    for (std::string line; std::getline(all, line);) lines_.push_back(line);
  }
  void write_rows(std::size_t rows) const {
    std::string text;
    for (std::size_t i = 0; i <= rows && i < lines_.size(); ++i) text += lines_[i] + "\n";
    where.write("series.csv", text);
  }
  void write_with(std::size_t row, const std::string& line) {
    lines_[row + 1] = line;
    write_rows(600);
  }
  [[nodiscard]] static json a_case() {
    return json::parse(R"({"kind": "monitor", "title": "Bridge",
      "series": {"file": "series.csv", "time": "hour",
                 "features": ["f1 [Hz]", "f2 [Hz]"], "covariates": ["air [degC]"]},
      "learning": {"until": 300, "hinges": 1},
      "alarm": {"false_alarms_per_year": 1}})");
  }
  [[nodiscard]] Outcome run(const json& c, const std::string& folder,
                            const std::string& options = "") const {
    return wheeltap(where, "monitor " + where.write_json("case.json", c).string() + " -o " +
                               (where / folder).string() + " --quiet " + options);
  }
  [[nodiscard]] json summary(const std::string& folder) const {
    return json::parse(read_all(where / (folder + "/summary.json")));
  }
  void expect_refused(const json& c, const std::string& text) const {
    const Outcome ran = run(c, "refused");
    EXPECT_EQ(ran.exit_code, 65) << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(text));
  }
  Workspace where;
  std::vector<std::string> lines_;
};

TEST_F(MonitorCommand, ContinuesToTheBitsOfARunInOneCall) {
  write_rows(230);
  ASSERT_EQ(run(a_case(), "whole").exit_code, 0);
  write_rows(200);
  ASSERT_EQ(run(a_case(), "parts").exit_code, 0);
  write_rows(230);
  const Outcome resumed = run(a_case(), "parts", "--resume");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(read_all(where / "whole/series.csv"), read_all(where / "parts/series.csv"));
  EXPECT_EQ(summary("whole")["monitor"], summary("parts")["monitor"]);
  EXPECT_EQ(summary("whole")["monitor"]["rows"], 230);
  EXPECT_THAT(read_all(where / "whole/report.html"), HasSubstr("Alarm statistic"));
  // Rows that were processed must not change.
  lines_[11] = lines_[12].substr(0, lines_[12].find(',')) + lines_[11].substr(lines_[11].find(','));
  lines_[12] = "22.5" + lines_[12].substr(lines_[12].find(','));
  write_rows(230);
  const Outcome changed = run(a_case(), "parts", "--resume");
  EXPECT_EQ(changed.exit_code, 65);
  EXPECT_THAT(changed.err, HasSubstr("have changed"));
}

TEST_F(MonitorCommand, FindsTheDamageOfTheStarterAndEndsWith3) {
  write_rows(1440);
  json c = a_case();
  c["learning"]["until"] = 1440;
  const Outcome ran = run(c, "out", "--alarm-exit");
  EXPECT_EQ(ran.exit_code, 3) << ran.err;
  const json monitor = summary("out")["monitor"];
  ASSERT_TRUE(monitor["alarm"].get<bool>());
  const json& first = monitor["alarms"][0];
  EXPECT_GE(first["time"].get<double>(), 2400.0);
  EXPECT_LE(first["onset"]["q2.5"].get<double>(), 2410.0);
  EXPECT_GE(first["onset"]["q97.5"].get<double>(), 2390.0);
  EXPECT_NEAR(first["features"][1]["shift"].get<double>(), -0.015,
              4.0 * first["features"][1]["sd"].get<double>());
  EXPECT_GT(monitor["false_alarms_per_year"]["replayed"].get<double>(), 0.0);
  const Outcome again = wheeltap(where, "report " + (where / "out").string());
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(MonitorCommand, NamesWhatIsWrong) {
  write_rows(600);
  json c = a_case();
  c["learning"]["until"] = 10;
  expect_refused(c, "/learning/until");
  c["learning"]["until"] = 1e6;
  expect_refused(c, "the series ends before this time");
  c = a_case();
  c["series"]["features"][1] = "f9";
  expect_refused(c, "/series/features/1");
  c = a_case();
  c["series"]["covariates"] = {"f2 [Hz]"};
  expect_refused(c, "/series/covariates/0: \"f2 [Hz]\": the column is also named in \"features\"");
  c = a_case();
  c["alarm"]["hazard_per_row"] = 0.1;
  expect_refused(c, "/alarm/hazard_per_row");
}

TEST_F(MonitorCommand, NamesTheRow) {
  const std::string kept = lines_[101];
  write_with(100, lines_[100]);
  expect_refused(a_case(), "the time equals that of the previous row");
  write_with(100, "3,4.0,5.1,9.9,4.0");
  expect_refused(a_case(), "time goes backwards");
  write_with(100, "200,4.0,-5.1,9.9,4.0");
  expect_refused(a_case(), "must be positive");
  write_with(100, ",4.0,5.1,9.9,4.0");
  expect_refused(a_case(), "line 102");
  write_with(100, kept);
}

TEST_F(MonitorCommand, NamesAConstantFeatureAndWarnsOfAConstantCovariate) {
  std::string text = "hour,f,air,still\n";
  for (int t = 0; t < 300; ++t)
    text += std::to_string(t) + ",4." + std::to_string(10 + (t * 7919) % 83) + "," +
            std::to_string(t % 24) + ",5\n";
  where.write("series.csv", text);
  json c = a_case();
  c["series"]["features"] = {"still"};
  c["series"]["covariates"] = {"air"};
  c["learning"]["until"] = 200;
  expect_refused(c, "is constant in the training period");
  c["series"]["features"] = {"f"};
  c["series"]["covariates"] = {"air", "still"};
  const Outcome ran = run(c, "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("is constant in the training period: its effect"));
}

// Fault: a transient of 72 rows explained the damage, so that the statistic stayed below a
// threshold of 1000 rows.
TEST_F(MonitorCommand, FindsDamageInTheFirstTestsWithoutAClock) {
  std::string text = "test,f1,f2\n";
  for (int t = 0; t < 100; ++t) {
    const double damage = t < 90 ? 1.0 : 0.97;
    text += std::to_string(t) + "," + std::to_string(damage * (4.0 + 1e-4 * ((t * 7919) % 83))) +
            "," + std::to_string(damage * (7.0 + 2e-4 * ((t * 104729) % 79))) + "\n";
  }
  where.write("series.csv", text);
  json c = a_case();
  c["series"] = {
      {"file", "series.csv"}, {"time", "test"}, {"time_unit", "row"}, {"features", {"f1", "f2"}}};
  c["learning"]["until"] = 60;
  c["alarm"] = {{"mean_rows_between_false_alarms", 1000}};
  const Outcome ran = run(c, "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json monitor = summary("out").at("monitor");
  ASSERT_EQ(monitor.at("alarms").size(), 1U);
  EXPECT_GE(monitor.at("first_alarm"), 90);
  EXPECT_LE(monitor.at("first_alarm"), 93);
}

// Fault: an error code in the training period inflated the covariate's sd silently.
TEST_F(MonitorCommand, WarnsOfErrorCodesAndUsesTheThresholdOfTheModel) {
  lines_[51].replace(lines_[51].rfind(',') + 1, std::string::npos, "-999");
  write_rows(600);
  json c = a_case();
  c["alarm"]["calibration"] = "model";
  const Outcome ran = run(c, "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("is -999 at"));
  const json threshold = summary("out").at("monitor").at("log_threshold");
  EXPECT_EQ(threshold.at("used"), threshold.at("stated"));
}

// Fault: a sensor that failed after the training period gave no warning, or an alarm alone.
TEST_F(MonitorCommand, WarnsOfColumnsThatStoppedVarying) {
  for (std::size_t row = 161; row < 231; ++row) {
    std::string& line = lines_[row];
    const std::size_t first = line.find(',');
    line.erase(first + 1, line.find(',', first + 1) - first - 1);
    line.replace(line.rfind(',') + 1, std::string::npos, "5");
  }
  write_rows(230);
  const Outcome ran = run(a_case(), "out");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const std::string warnings = summary("out")["diagnostics"]["warnings"].dump();
  EXPECT_THAT(warnings, HasSubstr("The feature f1 [Hz] has no value since 320 (70 rows)"));
  EXPECT_THAT(warnings, HasSubstr("The covariate air [degC] is 5 in all rows since 320 (70 rows)"));
  EXPECT_THAT(warnings, Not(HasSubstr("The feature f2")));
}

/// Entry /monitor of a summary, without or with one alarm.
Report monitor_entry(double probability) {
  return {{"alarm", false},
          {"alarms", Report::array()},
          {"rows", 900},
          {"learning_rows", 700},
          {"rows_with_features", 190},
          {"time_unit", "h"},
          {"log_statistic", 20.6},
          {"log_threshold", {{"stated", 10.7}, {"used", 23.2}}},
          {"probability_changed", probability}};
}

Report change_entry(double probability) {
  return {{"onset", {{"q2.5", 2390.0}, {"q50", 2400.0}, {"q97.5", 2410.0}}},
          {"probability_changed", probability},
          {"features",
           {{{"name", "f1"}, {"shift", 2e-4}, {"sd", 6e-4}, {"probability_shifted", 0.99}},
            {{"name", "f2"}, {"shift", -0.01}, {"sd", 1e-3}, {"probability_shifted", 1.0}}}}};
}

// Fault: "No alarm …; P(changed) > 99.9 %" without a reason, and an alarm at 80 % reported as one
// with the later probability of 11 %.
TEST(MonitorHeadline, ExplainsAProbableChangeWithoutAlarmAndAnAlarmOfAShiftThatPassed) {
  Report monitor = monitor_entry(0.9999);
  monitor["possible_change"] = change_entry(0.9999);
  EXPECT_EQ(monitor_headline(monitor),
            "No alarm in 200 monitored rows: the alarm statistic, ln S = 20.6, is below its "
            "threshold, 23.2. A change is nevertheless probable: P(changed) > 99.9 %, onset 2400 h "
            "(95 % interval 2390 to 2410 h), f2 by -1.00 % (sd 0.10 %).");
  monitor = monitor_entry(0.002);
  EXPECT_EQ(monitor_headline(monitor), "No alarm in 200 monitored rows; P(changed) = 0.2 %.");
  monitor["rows_with_features"] = 0;
  EXPECT_THAT(monitor_headline(monitor), HasSubstr("none of the 200 monitored rows has a value"));
  monitor = monitor_entry(0.11);
  monitor["alarm"] = true;
  Report alarm = change_entry(0.11);
  alarm["time"] = 2462.0;
  alarm["probability_at_alarm"] = 0.8;
  monitor["alarms"].push_back(alarm);
  EXPECT_THAT(monitor_headline(monitor),
              HasSubstr("probability 80 % at the alarm, but 11 % after further rows"));
}

}  // namespace
}  // namespace wheeltap::apps
