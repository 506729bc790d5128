// `wheeltap monitor` with modes of many tests as features, and `wheeltap track`.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/failure.hpp"
#include "base/random.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr int kHealthy = 60, kDamaged = 8;

/// modes.json of one test: modes near 4.5, 15 and 41 Hz, which damage lowers by 3, 2 and 10 %, and
/// a doubtful one in every third test.
json modes_of_test(int number) {
  base::Random random(7, static_cast<std::uint64_t>(number), 0, base::Purpose::test);
  const bool damaged = number > kHealthy;
  std::vector<double> frequencies = {4.5 * (damaged ? 0.97 : 1.0), 15.0 * (damaged ? 0.98 : 1.0),
                                     41.0 * (damaged ? 0.90 : 1.0)};
  json shapes = {{1.0, 0.7, 0.4}, {-0.6, 0.5, 1.0}, {0.5, -1.0, 0.6}};
  json doubtful = {false, false, false};
  for (double& f : frequencies) f *= std::exp(0.002 * random.normal());
  if (number % 3 == 0) {
    frequencies.push_back(42.0);
    shapes.push_back({0.4, -0.9, 1.0});
    doubtful.push_back(true);
  }
  const std::size_t n = frequencies.size();
  json none = json::array(), still = json::array();
  for (std::size_t m = 0; m < n; ++m) {
    none.push_back(nullptr);
    still.push_back({0.0, 0.0, 0.0});
  }
  return {{"title", "test " + std::to_string(number)},
          {"frequencies_hz", frequencies},
          {"damping", none},
          {"covariance", nullptr},
          {"sensors", {{{"name", "a"}}, {{"name", "b"}}, {{"name", "c"}}}},
          {"shapes", {{"real", shapes}, {"imaginary", still}}},
          {"shape_covariance", nullptr},
          {"doubtful", doubtful}};
}

class MonitoredModes : public testing::Test {
 protected:
  MonitoredModes() {
    std::filesystem::create_directory(where / "modes");
    for (int i = 1; i <= kHealthy + kDamaged; ++i)
      where.write("modes/" + std::to_string(1000 + i) + ".json", modes_of_test(i).dump());
  }
  [[nodiscard]] static json a_case() {
    return json::parse(R"({"kind": "monitor", "title": "Frame", "series": {"modes": "modes"},
      "learning": {"until": 40}, "alarm": {"mean_rows_between_false_alarms": 1000}})");
  }
  [[nodiscard]] Outcome run(const json& c, const std::string& options = "") const {
    return wheeltap(where, "monitor " + where.write_json("case.json", c).string() + " -o " +
                               (where / "out").string() + " --quiet " + options);
  }
  [[nodiscard]] MonitorCaseFile parsed(const json& c, const ModesReading& reading = {}) const {
    return parse_monitor_case(read_case(where.write_json("case.json", c)), reading);
  }
  Workspace where;
};

TEST_F(MonitoredModes, RaiseAnAlarmWithinSixTestsAndRunAProgram) {
  json c = a_case();
  c["on_alarm"]["command"] = {"sh", "-c", "cat > said.json"};
  EXPECT_EQ(run(c).exit_code, 64);
  const Outcome ran = run(c, "--allow-commands --alarm-exit --charts");
  ASSERT_EQ(ran.exit_code, 3) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("Alarm at row "));
  const json monitor = json::parse(read_all(where / "out/summary.json"))["monitor"];
  EXPECT_EQ(monitor["rows"], kHealthy + kDamaged);
  EXPECT_EQ(monitor["time_unit"], "row");
  ASSERT_EQ(monitor["tracked_modes"].size(), 3U);
  for (const json& mode : monitor["tracked_modes"]) EXPECT_EQ(mode["missing"], 0) << mode;
  const json& alarm = monitor["alarms"][0];
  EXPECT_GT(alarm["time"].get<int>(), kHealthy);
  EXPECT_LE(alarm["time"].get<int>(), kHealthy + 3);
  EXPECT_EQ(alarm["file"], "modes/" + std::to_string(1000 + alarm["time"].get<int>()) + ".json");
  const json said = json::parse(read_all(where / "said.json"));
  EXPECT_EQ(said["alarms"].size(), monitor["alarms"].size());
  EXPECT_THAT(said["headline"].get<std::string>(), HasSubstr("Alarm"));
  EXPECT_GE(monitor["charts"].size(), 5U);
  EXPECT_THAT(read_all(where / "out/report.html"), HasSubstr("Comparison charts"));
  EXPECT_THAT(read_all(where / "out/report.html"), HasSubstr("Tracked modes"));
  EXPECT_EQ(wheeltap(where, "report " + (where / "out").string()).exit_code, 0);
}

TEST_F(MonitoredModes, TrackWritesATableAndAFile) {
  const Outcome ran = wheeltap(where, "track " + (where / "modes").string() + " -o " +
                                          (where / "tracked.nc").string() + " --learning 40");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("f, median [Hz]"));
  EXPECT_GT(std::filesystem::file_size(where / "tracked.nc"), 1000U);
  std::string list;
  for (int i = 1; i <= kHealthy; ++i) list += "modes/" + std::to_string(1000 + i) + ".json\n";
  where.write("list.txt", list);
  const Outcome listed = wheeltap(where, "track " + (where / "list.txt").string() + " -o " +
                                             (where / "tracked.nc").string() + " --json");
  ASSERT_EQ(listed.exit_code, 0) << listed.err;
  const json table = json::parse(listed.out);
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[2]["identified"], kHealthy);
  where.write("list.txt", "modes/none.json\n");
  const Outcome missing = wheeltap(
      where, "track " + (where / "list.txt").string() + " -o " + (where / "tracked.nc").string());
  EXPECT_EQ(missing.exit_code, 66);
  EXPECT_THAT(missing.err, HasSubstr("none.json"));
}

TEST_F(MonitoredModes, TakeTimesAndCovariatesFromATable) {
  std::string times = "file,time,air\n";
  for (int i = 1; i <= kHealthy + kDamaged; ++i)
    times += std::to_string(1000 + i) + ".json," + std::to_string(24 * i) + "," +
             std::to_string(i % 7) + "\n";
  where.write("times.csv", times);
  json c = a_case();
  c["series"]["times"] = "times.csv";
  c["series"]["covariates"] = {"air"};
  c["learning"]["until"] = 24 * 40.5;
  c["alarm"] = json::object();
  const MonitorCaseFile found = parsed(c);
  EXPECT_EQ(found.time.unit, "h");
  EXPECT_EQ(found.learning_rows, 40);
  EXPECT_EQ(found.series.covariate_count(), 1);
  EXPECT_NEAR(found.features(kHealthy + 1, 2), 41.0 * 0.9, 1.0);
  where.write("times.csv", "file,time,air\nother.json,1,2\n");
  try {
    static_cast<void>(parsed(c));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("other.json is not among the files"));
  }
}

// Regression: each row of the table of times took the first file with the same name, in any folder.
TEST_F(MonitoredModes, FilesOfOneNameInSeveralFoldersAreSeveralTests) {
  std::string times = "file,time\n";
  for (int i = 1; i <= kHealthy + kDamaged; ++i) {
    const std::string name = "run" + std::to_string(1000 + i);
    std::filesystem::create_directories(where / "runs" / name);
    where.write("runs/" + name + "/modes.json", modes_of_test(i).dump());
    times += name + "/modes.json," + std::to_string(i) + "\n";
  }
  where.write("times.csv", times);
  json c = a_case();
  c["series"]["modes"] = "runs";
  c["series"]["times"] = "times.csv";
  c["alarm"] = json::object();
  const MonitorCaseFile found = parsed(c);
  EXPECT_EQ(found.series.rows(), kHealthy + kDamaged);
  EXPECT_NE(found.features(0, 0), found.features(1, 0));
  where.write("times.csv", "file,time\nmodes.json,1\n");
  try {
    static_cast<void>(parsed(c));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("modes.json names several files"));
  }
}

TEST_F(MonitoredModes, NameWhatIsWrong) {
  const auto expect = [&](const json& c, const std::string& text) {
    const Outcome ran = run(c);
    EXPECT_EQ(ran.exit_code, 65) << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(text));
  };
  json c = a_case();
  c["series"]["features"] = {"f1"};
  expect(c, "give only one of the two keys");
  c = a_case();
  c["series"].erase("modes");
  expect(c, "must have \"features\"");
  c = a_case();
  c["series"]["covariates"] = {"air"};
  expect(c, "/series/covariates");
  json other = modes_of_test(9);
  other["sensors"].push_back({{"name", "d"}});
  for (const char* part : {"real", "imaginary"})
    for (json& shape : other["shapes"][part]) shape.push_back(0.1);
  where.write("modes/1009.json", other.dump());
  expect(a_case(), "all tests must measure at the same sensors");
}

TEST_F(MonitoredModes, ALastLineWithoutItsEndWaits) {
  std::string text = "hour,f\n";
  for (int t = 0; t < 40; ++t)
    text += std::to_string(t) + ",4." + std::to_string(10 + t % 7) + "\n";
  where.write("series.csv", text + "40,4.1");
  json c = a_case();
  c["series"] = {{"file", "series.csv"}, {"time", "hour"}, {"features", {"f"}}};
  c["learning"]["until"] = 30;
  c["alarm"] = json::object();
  EXPECT_EQ(parsed(c, {.following = true}).series.rows(), 40);
  EXPECT_EQ(parsed(c).series.rows(), 41);
}

TEST_F(MonitoredModes, TimesWithAZoneAreInUtc) {
  std::string text = "date,f\n";
  for (int t = 0; t < 60; ++t) {  // clocks are set back between the two hours of 25 October
    const int hour = t % 24;
    const std::string zone = t < 30 ? "+02:00" : "+01:00";
    const int local = t < 30 ? hour : (t - 1) % 24;
    const int day = t < 30 ? 24 + t / 24 : 24 + (t - 1) / 24;
    text += "2026-10-" + std::to_string(day) + "T" + (local < 10 ? "0" : "") +
            std::to_string(local) + ":00" + zone + ",4." + std::to_string(10 + t % 7) + "\n";
  }
  where.write("series.csv", text);
  json c = a_case();
  c["series"] = {{"file", "series.csv"}, {"time", "date"}, {"features", {"f"}}};
  c["learning"]["until"] = "2026-10-25T20:00Z";
  c["alarm"] = json::object();
  const MonitorCaseFile found = parsed(c);
  EXPECT_NEAR(found.series.hours[31] - found.series.hours[30], 1.0, 1e-9);
  EXPECT_NEAR(found.series.hours[30] - found.series.hours[29], 1.0, 1e-9);
  c["learning"]["until"] = "2026-10-25T22:00+02:00";
  EXPECT_EQ(parsed(c).learning_rows, found.learning_rows);
}

TEST_F(MonitoredModes, AnEndOfLearningWithAZoneNeedsTimesWithAZone) {
  std::string text = "date,f\n";
  for (int t = 0; t < 48; ++t)
    text += "2026-10-" + std::to_string(24 + t / 24) + "T" + (t % 24 < 10 ? "0" : "") +
            std::to_string(t % 24) + ":00,4." + std::to_string(10 + t % 7) + "\n";
  where.write("series.csv", text);
  json c = a_case();
  c["series"] = {{"file", "series.csv"}, {"time", "date"}, {"features", {"f"}}};
  c["alarm"] = json::object();
  c["learning"]["until"] = "2026-10-25T12:00";
  EXPECT_EQ(parsed(c).learning_rows, 36);
  c["learning"]["until"] = "2026-10-25T12:00Z";
  try {
    static_cast<void>(parsed(c));
    ADD_FAILURE() << "expected an error";
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("states a time zone"));
  }
}

}  // namespace
}  // namespace wheeltap::apps
