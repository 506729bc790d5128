// `wheeltap data` on the command line.
#include <gmock/gmock.h>

#include <cmath>

#include "io/universal/universal_file.hpp"
#include "program.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class DataCommand : public testing::Test {
 protected:
  /// Two sines at 50 Hz sampling, one of them clipped and with a gap.
  void SetUp() override {
    std::string text = "time [s],tip [m],root [N]\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = i / 50.0;
      const double tip = std::sin(2 * 3.14159265358979 * 3.1 * t) + 0.01 * std::sin(1e3 * t * t);
      char line[100];
      std::snprintf(line, sizeof line, "%.3f,%.9g,%.9g\n", t, tip, std::min(0.8, 1.1 * tip));
      text += line;
    }
    where.write("record.csv", text);
  }
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return wheeltap(where, "data " + arguments);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (where / name).string(); }
  Workspace where;
};

TEST_F(DataCommand, TellsChannelsAndFaults) {
  const Outcome ran = run(path("record.csv"));
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("4 000 samples at 50 Hz, 80 s"));
  EXPECT_THAT(ran.out, HasSubstr("tip [m]"));
  EXPECT_THAT(ran.out, HasSubstr("! root is clipped"));
  EXPECT_THAT(ran.out, Not(HasSubstr("! tip")));
  const json out = json::parse(run(path("record.csv") + " --json").out);
  const json& tip = out["tables"][0]["channels"][0];
  EXPECT_NEAR(tip["rms"].get<double>(), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(tip["peaks"][0]["frequency_hz"].get<double>(), 3.1, 0.02);
  EXPECT_EQ(out["tables"][0]["sample_rate_hz"], 50.0);
}

// Fault: Latin-1 text of a logger, and a file name that is not UTF-8, gave exit code 70 with
// --json.
TEST_F(DataCommand, TextsThatAreNotUtf8) {
  where.write("Weg\xff.csv", "time [s],Weg [\xb5m],Kraft [N]\n0,1,2\n0.1,2,4\n0.2,1,3\n0.3,2,5\n");
  const Outcome ran = run(path("Weg\xff.csv") + " --json");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json out = json::parse(ran.out);
  EXPECT_THAT(out["file"].get<std::string>(), HasSubstr("Weg\\xff.csv"));
  EXPECT_EQ(out["tables"][0]["channels"][0]["unit"], "µm");
}

// The output states the detected layout and asks for missing information.
TEST_F(DataCommand, SaysHowATextIsRead) {
  where.write("one.txt", "0,1108\n-0,1845\n0,2598\n0,0751\n");
  EXPECT_THAT(run(path("one.txt")).out, HasSubstr("One column, decimal comma"));
  where.write("ms.csv", "Time_ms,acc_g\n0,1\n10,2\n20,1\n30,3\n");
  const std::string out = run(path("ms.csv")).out;
  EXPECT_THAT(out, HasSubstr("at 100 Hz"));
  EXPECT_THAT(out, HasSubstr("state \"unit\": \"g\""));
  where.write("whole.csv", "time,acc\n0,1\n10,2\n20,1\n30,3\n");
  EXPECT_THAT(run(path("whole.csv")).out, HasSubstr("\"scale\": 0.001"));
  where.write("fs.txt", "Fs = 200 Hz\nacc [g]\n1\n2\n1\n3\n");
  EXPECT_THAT(run(path("fs.txt")).out, HasSubstr("200 Hz, as stated in line 1"));
  where.write("tail.csv", "time [s],a [g]\n0,1\n0.1,2\n0.2,3\n\nEnd of test\n");
  EXPECT_THAT(run(path("tail.csv")).out, HasSubstr("line 6 after the rows is not part"));
}

// All bits survive a round trip in every format.
TEST_F(DataCommand, ConvertsWithoutLoss) {
  const signals::Record before = signals::read_record(path("record.csv"));
  ASSERT_EQ(run(path("record.csv") + " --to " + path("a.csv")).exit_code, 0);
  const signals::Record after = signals::read_record(path("a.csv"));
  ASSERT_EQ(after.columns.size(), 3U);
  EXPECT_EQ(after.columns[1].values, before.columns[1].values);
  EXPECT_EQ(after.columns[2].header, "root [N]");
  ASSERT_EQ(run(path("record.csv") + " --to " + path("a.uff")).exit_code, 0);
  const io::UniversalFile file = io::read_universal_file(path("a.uff"));
  ASSERT_EQ(file.functions.size(), 2U);
  EXPECT_NEAR(file.functions[0].step, 0.02, 1e-12);
  EXPECT_EQ(file.functions[1].numerator.unit, "N");
  for (std::size_t i = 0; i < 4000; ++i)
    ASSERT_NEAR(file.functions[0].y[i].real(), before.columns[1].values[i], 1e-11);
  ASSERT_EQ(run(path("a.uff") + " --to " + path("b.csv")).exit_code, 0);
  const signals::Record back = signals::read_record(path("b.csv"));
  EXPECT_EQ(back.rows(), 4000);
  ASSERT_EQ(run(path("record.csv") + " --to " + path("a.nc")).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(path("a.nc")), 90000U);
}

// A file name may contain terminal control sequences.
TEST_F(DataCommand, ConvertedNamesAreShownWithoutControlCharacters) {
  const Outcome ran = run(path("record.csv") + " --to \"" + path("a\x1b[31m.csv") + "\"");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("a\\x1b[31m.csv"));
  EXPECT_THAT(ran.out, Not(HasSubstr("\x1b")));
}

TEST_F(DataCommand, DrawsAPage) {
  ASSERT_EQ(run(path("record.csv") + " -o " + path("page.html")).exit_code, 0);
  const std::string page = read_all(path("page.html"));
  EXPECT_THAT(page, HasSubstr("tip [m]"));
  EXPECT_THAT(page, HasSubstr("is clipped"));
  EXPECT_THAT(
      page,
      Not(testing::ContainsRegex(R"((src|href)="?http|url\(.?http|https:)")));  // loads nothing
  EXPECT_THAT(page, Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
}

TEST_F(DataCommand, Refusals) {
  EXPECT_EQ(run(path("missing.csv")).exit_code, 66);
  where.write("x.xyz", "1,2\n");
  EXPECT_EQ(run(path("x.xyz")).exit_code, 65);
  EXPECT_EQ(run(path("record.csv") + " --to pdf").exit_code, 64);
  EXPECT_EQ(run(path("record.csv") + " --to " + path("record.csv")).exit_code, 64);
  EXPECT_EQ(run(path("record.csv") + " --to /dev/null/a.csv").exit_code, 73);
  EXPECT_EQ(run(path("record.csv") + " --sample-rate -5").exit_code, 64);
  where.write("gap.csv", "time,a\n0,1\n0.1,2\n0.2,3\n0.7,4\n0.8,5\n");
  const Outcome gap = run(path("gap.csv"));
  EXPECT_EQ(gap.exit_code, 0) << gap.err;
  EXPECT_THAT(gap.out, HasSubstr("line 5"));
}

}  // namespace
}  // namespace wheeltap::apps
