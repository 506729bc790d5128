// `wheeltap modal` on the command line.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <sstream>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Two oscillators at 1 and 3 Hz under noise, measured by two sensors, 20 Hz, 600 s.
class ModalCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::string text = "a [m/s^2],b [m/s^2],still\n";
    std::array<std::array<double, 2>, 2> x{};
    std::uint64_t bits = 88172645463325252U;
    const auto noise = [&bits] {
      double sum = -6.0;
      for (int i = 0; i < 12; ++i) {
        bits ^= bits << 13U;
        bits ^= bits >> 7U;
        bits ^= bits << 17U;
        sum += static_cast<double>(bits >> 11U) * 0x1.0p-53;
      }
      return sum;
    };
    for (int k = 0; k < 12000; ++k) {
      for (std::size_t m = 0; m < 2; ++m) {
        // x'' as an autoregression with the poles of a mode with 1 % damping.
        const double w = 2.0 * 3.14159265358979 * (m == 0 ? 1.0 : 3.0) * 0.05,
                     r = std::exp(-0.01 * w);
        const double next = 2.0 * r * std::cos(w) * x[m][0] - r * r * x[m][1] + noise();
        x[m] = {next, x[m][0]};
      }
      char line[100];
      std::snprintf(line, sizeof line, "%.9g,%.9g,3\n", x[0][0] + 0.3 * x[1][0] + 0.05 * noise(),
                    0.5 * x[0][0] - x[1][0] + 0.05 * noise());
      text += line;
    }
    where.write("record.csv", text);
  }
  [[nodiscard]] static json a_case() {
    return json::parse(R"({"kind": "modal", "title": "Two", "band": [0.3, 9.0],
      "record": {"file": "record.csv", "sample_rate": 20, "channels": [
        {"column": "a", "role": "response", "node": "tip", "direction": "x"},
        {"column": "b", "role": "response", "node": 7, "azimuth": 90}]}})");
  }
  [[nodiscard]] Outcome run(const json& c, const std::string& options = "") const {
    return wheeltap(where, "modal " + where.write_json("case.json", c).string() + " -o " +
                               (where / "out").string() + " " + options);
  }
  Workspace where;
};

TEST_F(ModalCommand, FindsModesAndWritesThem) {
  const Outcome ran = run(a_case());
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("Two"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  for (std::size_t m = 0; m < 2; ++m) {
    const double sd = std::sqrt(modes["covariance"][m][m].get<double>());
    EXPECT_NEAR(modes["frequencies_hz"][m].get<double>(), m == 0 ? 1.0 : 3.0, 5.0 * sd + 1e-3);
    EXPECT_NEAR(modes["damping"][m].get<double>(), 0.01, 0.005);
  }
  EXPECT_EQ(modes["covariance"].size(), 4U);
  EXPECT_EQ(modes["shape_covariance"][0].size(), 4U);
  EXPECT_EQ(modes["sensors"][0]["node"], "tip");
  EXPECT_EQ(modes["sensors"][1]["node"], "7");
  EXPECT_EQ(modes["sensors"][1]["azimuth"], 90.0);
  EXPECT_NEAR(modes["shapes"]["real"][0][1].get<double>(), 0.5, 0.05);
  const std::string page = read_all(where / "out/report.html");
  EXPECT_THAT(page, HasSubstr("Stabilisation diagram"));
  EXPECT_THAT(
      page,
      Not(testing::ContainsRegex(R"((src|href)="?http|url\(.?http|https:)")));  // loads nothing
  EXPECT_THAT(page, Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_EQ(summary["wheeltap"]["command"], "modal");
  EXPECT_EQ(summary["modes"].size(), 2U);
}

/// The record in two halves, as if sensor b had been moved from one node to another.
json two_set_ups(json c) {
  json second = c["record"];
  c["record"]["samples"] = {0, 6000};
  second["samples"] = {6000, 12000};
  second["channels"][1]["node"] = 8;
  c["records"] = {c["record"], second};
  c.erase("record");
  for (json& r : c["records"]) r["channels"][0]["reference"] = true;
  return c;
}

/// The case on a tower: sensor a at its top along x, b at 7 along y.
json drawn_case(json c) {
  c["geometry"] = json::parse(R"({"nodes": {"foot": [0, 0, 0], "7": [0, 0, 1], "tip": [0, 0, 2],
    "idle": [1, 0, 2]}, "lines": [["foot", 7, "tip"], ["tip", "idle"]], "fixed": ["foot"]})");
  return c;
}

TEST_F(ModalCommand, ReportIsDrawnAgainFromWhatIsKept) {
  for (const json& c : {drawn_case(a_case()), two_set_ups(a_case())}) {
    ASSERT_EQ(run(c).exit_code, 0);
    const std::string page = read_all(where / "out/report.html");
    std::filesystem::remove(where / "out/report.html");
    const std::string again = "report " + (where / "out").string();
    ASSERT_EQ(wheeltap(where, again).exit_code, 0);
    EXPECT_EQ(read_all(where / "out/report.html"), page);
    for (const char* part : {"Mode shapes", "Modal assurance criterion", "Complexity",
                             "Damping, with 95 % intervals", "Rejected poles"})
      EXPECT_THAT(page, HasSubstr(part));
    EXPECT_EQ(wheeltap(where, again + " --figures").exit_code, 64);
  }
}

TEST_F(ModalCommand, ReportOfWhatIsNotWhatARunWroteIsRefused) {
  ASSERT_EQ(run(drawn_case(a_case())).exit_code, 0);
  const std::string page = read_all(where / "out/report.html");
  const json summary = json::parse(read_all(where / "out/summary.json"));
  const auto refused = [&](int code, const std::string& said) {
    const Outcome again = wheeltap(where, "report " + (where / "out").string());
    EXPECT_EQ(again.exit_code, code) << again.err;
    EXPECT_THAT(again.err, HasSubstr(said));
    EXPECT_TRUE(read_all(where / "out/report.html") == page);
  };
  for (const char* key :
       {"modes", "procedure", "stabilisation", "rejected", "spectrum", "diagnostics", "geometry"})
    for (const json& wrong : {json(3), json(nullptr), json("text"), json{{1, 2}, {"x"}}}) {
      json changed = summary;
      changed[key] = wrong;
      where.write("out/summary.json", changed.dump());
      refused(65, "summary.json");
    }
  json changed = summary;
  changed["geometry"]["lines"][0][0] = "nowhere";
  where.write("out/summary.json", changed.dump());
  refused(65, "summary.json");
  where.write("out/summary.json", summary.dump());
  json modes = json::parse(read_all(where / "out/modes.json"));
  modes["frequencies_hz"][0] = 5.0;
  where.write("out/modes.json", modes.dump(1) + "\n");
  refused(65, "modes.json");
  std::filesystem::remove(where / "out/modes.json");
  refused(66, "modes.json");
}

TEST_F(ModalCommand, ShapesAreDrawnOnTheGeometry) {
  ASSERT_EQ(run(drawn_case(a_case())).exit_code, 0);
  const std::string page = read_all(where / "out/report.html");
  const std::size_t from = page.find("shapeView({");
  ASSERT_NE(from, std::string::npos);
  const std::size_t begin = from + 10;
  const json drawn = json::parse(page.substr(begin, page.find(", element)", begin) - begin));
  EXPECT_EQ(drawn["dimension"], 3);
  const json& drawing = drawn["drawing"];
  // Four nodes at rest, two that move; each mode's motions of all of them.
  ASSERT_EQ(drawing["points"].size(), 6U);
  const json& motions = drawing["modes"][0]["motions"];
  ASSERT_EQ(motions.size(), 6U);
  // By name: 7, foot, idle, tip at rest; in the sensors' order tip and 7 moved.
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(motions[i], (json{0.0, 0.0, 0.0}));
  EXPECT_NEAR(std::abs(motions[4][0].get<double>()), 1.0, 0.01);
  EXPECT_NEAR(motions[5][1].get<double>() / motions[4][0].get<double>(), 0.5, 0.05);
  EXPECT_EQ(motions[5][2], 0.0);
  // foot to 7 moves at one end; the line to the idle node stays.
  const json& lines = drawing["lines"];
  const auto has = [&](int a, int b) { return std::ranges::count(lines, json{a, b}) == 1; };
  EXPECT_TRUE(has(1, 5) && has(5, 4) && has(3, 2) && !has(4, 2)) << lines;
}

TEST_F(ModalCommand, GeometryOfAStructureAndWhatDoesNotFit) {
  where.write("frame.json", R"({"kind": "damage", "structure": {"dimension": 2,
    "nodes": {"7": [0, 1], "tip": [0, 2], "foot": [0, 0]},
    "members": [{"name": "a", "nodes": ["foot", "7"]}, {"name": "b", "nodes": ["7", "tip"]}],
    "supports": [{"node": "foot", "fix": ["x"]}]}})");
  json c = a_case();
  c["geometry"] = "frame.json";
  ASSERT_EQ(run(c).exit_code, 0);
  const json kept = json::parse(read_all(where / "out/summary.json"))["geometry"];
  EXPECT_EQ(kept["lines"], json::parse(R"([["foot", "7"], ["7", "tip"]])"));
  EXPECT_EQ(kept["fixed"], json::parse(R"(["foot"])"));
  const auto refused = [&](const json& wrong, const std::string& said, int code = 65) {
    const Outcome ran = run(wrong);
    EXPECT_EQ(ran.exit_code, code) << said;
    EXPECT_THAT(ran.err, HasSubstr(said));
  };
  c["geometry"] = "nowhere.json";
  refused(c, "nowhere.json", 66);
  c["geometry"] = "case.json";
  refused(c, "/geometry");
  c = drawn_case(a_case());
  c["geometry"]["nodes"].erase("tip");
  refused(c, "/geometry/lines/0/2");
  c["geometry"].erase("lines");
  refused(c, "/record/channels/0/node");
  c = drawn_case(a_case());
  c["record"]["channels"][0]["direction"] = "up";
  refused(c, "/record/channels/0/direction");
  c = drawn_case(a_case());
  c["geometry"]["fixed"] = {"moon"};
  refused(c, "/geometry/fixed/0");
}

TEST_F(ModalCommand, NamesTheChannelThatCopiesAnother) {
  std::istringstream lines(read_all(where / "record.csv"));
  std::string text = "a,copy\n", line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const double a = std::stod(line);
    char row[80];
    std::snprintf(row, sizeof row, "%.9g,%.9g\n", a, -2.0 * a);
    text += row;
  }
  where.write("copied.csv", text);
  json c = a_case();
  c["record"]["file"] = "copied.csv";
  c["record"]["channels"][1]["column"] = "copy";
  const Outcome ran = run(c);
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("/record/channels/1: equals a except for its scale"));
}

TEST_F(ModalCommand, RefusesWhatCannotBe) {
  const auto refused = [&](const json& c, const std::string& said) {
    const Outcome ran = run(c);
    EXPECT_EQ(ran.exit_code, 65) << said;
    EXPECT_THAT(ran.err, HasSubstr(said));
  };
  json c = a_case();
  c["record"].erase("sample_rate");
  refused(c, "/record/sample_rate");
  c = a_case();
  c["band"] = {5.0, 2.0};
  refused(c, "/band");
  c["band"] = {1.0, 12.0};
  refused(c, "/band/1");
  c = a_case();
  c["record"]["channels"][1]["column"] = "still";
  refused(c, "/record/channels/1");
  c = a_case();
  c["record"]["channels"][1]["column"] = "a";
  refused(c, "omit one of the two");
  c = a_case();
  c["record"]["channels"][0]["role"] = "force";
  refused(c, "/record/channels/0/role");
  c = a_case();
  c["record"]["samples"] = {0, 20};
  refused(c, "/record");
  c["record"]["samples"] = {0, 20000};
  refused(c, "20000");
}

TEST_F(ModalCommand, SetUpsAreMerged) {
  const Outcome ran = run(two_set_ups(a_case()));
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("2 of 2"));
  EXPECT_THAT(ran.out, HasSubstr("by the one sensor common to all"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  ASSERT_EQ(modes["sensors"].size(), 3U);
  EXPECT_EQ(modes["sensors"][2]["node"], "8");
  for (const std::size_t k : {1, 2})
    EXPECT_NEAR(modes["shapes"]["real"][0][k].get<double>(), 0.5, 0.05);
  EXPECT_EQ(modes["shape_covariance"][0].size(), 6U);
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_EQ(summary["set_ups"].size(), 2U);
  EXPECT_EQ(summary["modes"][1]["places"], (json{1, 1}));
  const std::string page = read_all(where / "out/report.html");
  EXPECT_THAT(page, HasSubstr("Agreement of the set-ups"));
  EXPECT_THAT(page, Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
}

TEST_F(ModalCommand, SetUpsAreMergedBeforeTheyAreIdentified) {
  json c = two_set_ups(a_case());
  c["merge"] = "preger";
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("2 set-ups were merged"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  ASSERT_EQ(modes["sensors"].size(), 3U);
  for (const std::size_t k : {1, 2})
    EXPECT_NEAR(modes["shapes"]["real"][0][k].get<double>(), 0.5, 0.1);
  EXPECT_EQ(wheeltap(where, "report " + (where / "out").string()).exit_code, 0);
  c["method"] = "efdd";
  EXPECT_THAT(run(c).err, HasSubstr("/merge"));
  c.erase("method");
  c["records"][1]["sample_rate"] = 40;
  EXPECT_THAT(run(c).err, HasSubstr("/records/1"));
  c["record"] = c["records"][0];
  c.erase("records");
  EXPECT_THAT(run(c).err, HasSubstr("/merge"));
}

TEST_F(ModalCommand, SetUpsThatCannotBeMergedAreRefused) {
  const auto refused = [&](const json& c, const std::string& said) {
    const Outcome ran = run(c);
    EXPECT_EQ(ran.exit_code, 65) << said;
    EXPECT_THAT(ran.err, HasSubstr(said));
  };
  json c = two_set_ups(a_case());
  c["records"][1]["channels"][0]["node"] = "elsewhere";
  refused(c, "/records/0/channels/0/reference");
  for (json& r : c["records"]) r["channels"][0].erase("reference");
  refused(c, "/records: ");
  c = two_set_ups(a_case());
  c["records"][1]["channels"][1] = c["records"][1]["channels"][0];
  refused(c, "/records/1/channels/1");
  c = two_set_ups(a_case());
  c["record"] = c["records"][0];
  refused(c, "/records");
  c.erase("record");
  c.erase("records");
  refused(c, "/record");
}

// Faults: units in headers were ignored, so that shapes mixed g and m/s²; an ignored column of
// dates was read as numbers.
TEST_F(ModalCommand, UnitsOfHeadersAreAppliedAndIgnoredColumnsAreNotRead) {
  std::istringstream lines(read_all(where / "record.csv"));
  std::string line, text = "Time (-),a [g],b [m/s^2]\n";
  std::getline(lines, line);
  for (int n = 0; std::getline(lines, line); ++n) {
    double a = 0.0, b = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &a, &b), 2);
    char row[120];
    std::snprintf(row, sizeof row, "2022-11-04 08:36 and %d,%.9g,%.9g\n", n, a / 9.80665, b);
    text += row;
  }
  const json si_modes = [&] {
    EXPECT_EQ(run(a_case()).exit_code, 0);
    return json::parse(read_all(where / "out/modes.json"));
  }();
  where.write("mixed.csv", text);
  json c = a_case();
  c["record"]["file"] = "mixed.csv";
  c["record"]["channels"].push_back({{"column", "Time (-)"}, {"role", "ignore"}});
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("a: g, times 9.80665 in m/s^2"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(modes["shapes"]["real"][m][i].get<double>(),
                  si_modes["shapes"]["real"][m][i].get<double>(), 1e-4);
}

TEST_F(ModalCommand, AQuantityThatOnlyOneChannelStatesIsAsked) {
  std::string text = read_all(where / "record.csv");
  where.write("record.csv", "a,b,still" + text.substr(text.find('\n')));
  json c = a_case();
  c["record"]["channels"][1]["quantity"] = "velocity";
  EXPECT_THAT(run(c).out, HasSubstr("The quantity of a is unknown"));
}

// A free beam, one response and two hammer positions: its frequency lines are farther apart than
// the width of its resonances.
TEST_F(ModalCommand, FrequencyResponsesOfAUniversalFile) {
  json c = {{"kind", "modal"}, {"method", "plscf"}, {"band", {20.0, 1000.0}}};
  c["record"]["file"] = WHEELTAP_DATA "/uff/measurement_points1-2.uff";
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("by reciprocity"));
  EXPECT_THAT(ran.out, HasSubstr("narrower than the frequency"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  for (const double known : {51.52, 142.18, 278.67, 460.40, 687.17, 958.54}) {
    double off = 1.0;
    for (const double f : modes["frequencies_hz"].get<std::vector<double>>())
      off = std::min(off, std::abs(f / known - 1.0));
    EXPECT_LT(off, 1e-3) << known << "\n" << ran.out;
  }
  EXPECT_EQ(modes["sensors"].size(), 2U);
  EXPECT_THAT(read_all(where / "out/report.html"), Not(HasSubstr(">nan")));
}

TEST_F(ModalCommand, FrequencyResponsesThatCannotBeAreRefused) {
  const auto refused = [&](const json& c, const std::string& said, int code = 65) {
    const Outcome ran = run(c);
    EXPECT_EQ(ran.exit_code, code) << said;
    EXPECT_THAT(ran.err, HasSubstr(said));
  };
  json c = a_case();
  c["record"].erase("channels");
  refused(c, "/record/channels: is missing");
  c["method"] = "plscf";
  c["record"].erase("sample_rate");
  refused(c, "record.csv");
  c["record"]["file"] = "nowhere.uff";
  refused(c, "nowhere.uff", 66);
  c["record"]["file"] = WHEELTAP_DATA "/uff/sample_dataset58_psd.uff";
  refused(c, "holds no frequency response");
  c = a_case();
  c["method"] = "plscf";
  refused(c, "has no channel with the role \"force\"");
  c["record"]["channels"][0]["role"] = "force";
  refused(c, "/record/channels/0/unit: is missing");
  c["record"]["channels"][0]["unit"] = "N";
  c["lags"] = 20;
  refused(c, "/lags");
  c = a_case();
  c["segment"] = 512;
  refused(c, "/segment");
}

// Oscillator b driven by the measured motion of a is not a structure, but has a response.
TEST_F(ModalCommand, ForcesAndResponsesOfARecord) {
  json c = a_case();
  c["method"] = "plscf";
  c["record"]["channels"][0]["role"] = "force";
  c["record"]["channels"][0]["unit"] = "N";
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_EQ(summary["procedure"]["method"], "plscf");
  EXPECT_THAT(run(c, "--dry-run").out, HasSubstr("1 responses of 1 inputs"));
}

TEST_F(ModalCommand, FreeDecays) {
  std::string text = "y\n";
  for (int k = 0; k < 1200; ++k) {
    const double t = 0.05 * (k % 600);
    char line[40];
    std::snprintf(line, sizeof line, "%.9g\n",
                  std::exp(-0.1 * t) * std::sin(9.0 * t) +
                      0.5 * std::exp(-0.2 * t) * std::cos(20.0 * t) +
                      1e-3 * std::sin(1e4 * std::sin(99.0 * k)));
    text += line;
  }
  where.write("decay.csv", text);
  json c = {{"kind", "modal"}, {"method", "era"}};
  c["record"] = {{"file", "decay.csv"},
                 {"sample_rate", 20},
                 {"channels", {{{"column", "y"}, {"role", "response"}}}},
                 {"decays", {{0, 400}, {600, 1000}}}};
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  EXPECT_NEAR(modes["frequencies_hz"][0].get<double>(), std::hypot(9.0, 0.1) / 6.283185307, 1e-3);
  EXPECT_NEAR(modes["damping"][1].get<double>(), 0.01, 1e-3);
  c["record"]["decays"][1][1] = 2000;
  EXPECT_THAT(run(c).err, HasSubstr("/record/decays/1"));
  for (const json& second : {json{0, 400}, json{399, 800}}) {  // would count samples twice
    c["record"]["decays"][1] = second;
    const Outcome twice = run(c);
    EXPECT_EQ(twice.exit_code, 65);
    EXPECT_THAT(twice.err, HasSubstr("/record/decays/1: "));
    EXPECT_THAT(twice.err, HasSubstr("overlaps window 0"));
  }
  c["record"].erase("decays");
  EXPECT_THAT(run(c).err, HasSubstr("/record/decays"));
  c = a_case();
  c["record"]["decays"] = {{0, 400}};
  EXPECT_THAT(run(c).err, HasSubstr("/record/decays"));
}

TEST_F(ModalCommand, BandsByBayes) {
  json c = a_case();
  c.erase("band");
  c["method"] = "bayoma";
  c["bands"] =
      json::parse(R"([{"band": [0.8, 1.2], "modes": [1.0]}, {"band": [2.6, 3.4], "modes": [3]}])");
  const Outcome outcome = run(c);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("posterior of each band's modes"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const double sd = std::sqrt(modes["covariance"][i][i].get<double>());
    EXPECT_NEAR(modes["frequencies_hz"][i].get<double>(), i == 0 ? 1.0 : 3.0, 4.0 * sd);
    EXPECT_GT(sd, 0.0);
    EXPECT_NEAR(modes["damping"][i].get<double>(), 0.01, 0.01);
  }
  EXPECT_EQ(modes["covariance"][0][1], 0.0);  // modes in different bands
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_EQ(summary["procedure"]["method"], "bayoma");

  const auto refused = [&](const json& changed, const char* words) {
    const Outcome bad = run(changed);
    EXPECT_EQ(bad.exit_code, 65) << words;
    EXPECT_THAT(bad.err, HasSubstr(words));
  };
  json bad = c;
  bad["band"] = {0.3, 9.0};
  refused(bad, "/band");
  bad = c;
  bad["bands"][1]["modes"] = {9.0};
  refused(bad, "/bands/1");
  bad = c;
  bad.erase("bands");
  refused(bad, "/bands");
  bad = c;
  bad.erase("method");
  refused(bad, "/bands");
}

TEST_F(ModalCommand, PeaksOfSpectraSayNothingOfScatterAndAreNoData) {
  json c = a_case();
  c["method"] = "fdd";
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("no standard deviations"));
  EXPECT_THAT(ran.out, Not(HasSubstr("±")));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  for (std::size_t m = 0; m < 2; ++m)  // within the spacing of lines
    EXPECT_NEAR(modes["frequencies_hz"][m].get<double>(), m == 0 ? 1.0 : 3.0, 20.0 / 512.0);
  for (const char* key : {"covariance", "shape_covariance"}) EXPECT_TRUE(modes[key].is_null());
  EXPECT_TRUE(modes["damping"][0].is_null());
  EXPECT_THAT(read_all(where / "out/report.html"), Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
  EXPECT_EQ(wheeltap(where, "report " + (where / "out").string()).exit_code, 0);
  const json update = json::parse(R"({"kind": "update", "structure": {"chain": {"masses": [1, 1],
    "links": [{"name": "a", "between": [0, 1], "stiffness": "k"},
              {"name": "b", "between": [1, 2], "stiffness": 100}]}},
    "parameters": {"k": {"log_normal": [4.6, 0.3]}}, "data": {"from": "out/modes.json"}})");
  const Outcome refused =
      wheeltap(where, "update " + where.write_json("update.json", update).string() + " -o " +
                          (where / "updated").string());
  EXPECT_EQ(refused.exit_code, 65) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("/covariance: is null"));
  for (const char* key : {"lags", "blocks"}) {
    json bad = c;
    bad[key] = 20;
    EXPECT_THAT(run(bad).err, HasSubstr(std::string("/") + key));
  }
  json bad = two_set_ups(c);
  EXPECT_THAT(run(bad).err, HasSubstr("/method"));
}

TEST_F(ModalCommand, DecaysOfSpectraHaveTheScatterOfBlocks) {
  json c = a_case();
  c["method"] = "efdd";
  const Outcome ran = run(c);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("do not include bias"));
  const json modes = json::parse(read_all(where / "out/modes.json"));
  ASSERT_EQ(modes["frequencies_hz"].size(), 2U) << ran.out;
  EXPECT_EQ(modes["blocks"], 20);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_NEAR(modes["frequencies_hz"][m].get<double>(), m == 0 ? 1.0 : 3.0,
                5.0 * std::sqrt(modes["covariance"][m][m].get<double>()) + 1e-3);
    EXPECT_NEAR(modes["damping"][m].get<double>(), 0.01, 0.006);
  }
  EXPECT_EQ(run(two_set_ups(c)).exit_code, 0);
}

// A batch with a healthy record, a damaged record and a failing case.
TEST_F(ModalCommand, BatchesTakeModalCases) {
  json bad = a_case();
  bad["record"]["file"] = "nowhere.csv";
  for (const auto& [name, c] :
       {std::pair{"healthy.json", a_case()}, {"damaged.json", a_case()}, {"bad.json", bad}})
    static_cast<void>(where.write_json(name, c));
  const auto list = where.write("list.txt", "healthy.json\nbad.json\ndamaged.json\n");
  const std::string folder = (where / "batch").string();
  const Outcome ran = wheeltap(where, "batch " + list.string() + " -o " + folder + " --quiet");
  EXPECT_EQ(ran.exit_code, 66) << ran.err;
  const std::string table = read_all(where / "batch/batch.csv");
  EXPECT_THAT(table, HasSubstr("healthy,modal,0,2 modes"));
  EXPECT_THAT(table, HasSubstr("damaged,modal,0,2 modes"));
  EXPECT_THAT(table, HasSubstr("bad,modal,66,"));
  ASSERT_EQ(run(a_case()).exit_code, 0);
  for (const char* name : {"healthy", "damaged"})
    EXPECT_EQ(read_all((where / "batch") / name / "modes.json"),
              read_all(where / "out/modes.json"));
}

TEST_F(ModalCommand, DryRunWritesNothing) {
  const Outcome ran =
      wheeltap(where, "modal " + where.write_json("case.json", a_case()).string() + " --dry-run");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("2 responses of 12 000 samples"));
}

}  // namespace
}  // namespace wheeltap::apps
