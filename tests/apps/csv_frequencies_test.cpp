#include "apps/cases/records/csv_frequencies.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "io/file_error.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using testing::HasSubstr;

std::string csv_complaint(const std::string& text, const FrequencyCells& cells) {
  const Workspace where;
  try {
    (void)read_frequency_csv(where.write("f.csv", text), cells);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    return failure.what();
  }
  return "";
}

TEST(CsvFrequencies, ReadsWhatItWrites) {
  const Workspace where;
  const FrequencyTable table{{13.852289123456789, 55.4, 124.6}, {0.0138, 0.05, 0.1}};
  const auto back = read_frequency_csv(where.write("f.csv", frequency_csv(table, "a comment")), {});
  EXPECT_EQ(back.frequencies_hz, table.frequencies_hz);
  EXPECT_EQ(back.sd_hz, table.sd_hz);
}

TEST(CsvFrequencies, ReadsARowByColumnNamesOrNumbers) {
  const Workspace where;
  const auto path = where.write("f.csv", "V,f1 [Hz],f2\n1.2,26.1,160\n1.6,28.2,\n");
  const auto first = read_frequency_csv(path, {.columns = {"f1", "f2"}, .row = 1});
  EXPECT_EQ(first.frequencies_hz, (std::vector<double>{26.1, 160.0}));
  const auto second = read_frequency_csv(path, {.columns = {"2", "3"}, .row = 2});
  EXPECT_EQ(second.frequencies_hz[0], 28.2);
  EXPECT_TRUE(std::isnan(second.frequencies_hz[1])) << "an empty cell is a mode not measured";
}

TEST(CsvFrequencies, NamesLineAndColumnOfAFault) {
  EXPECT_THAT(csv_complaint("mode,frequency\n1,13.8\n2,x\n", {}), HasSubstr("f.csv:3:2: \"x\""));
  EXPECT_THAT(csv_complaint("mode,frequency\n1,-3\n", {}), HasSubstr("f.csv:2:2"));
  EXPECT_THAT(csv_complaint("mode,frequency\n1,12 Hz\n", {}), HasSubstr("f.csv:2:2"));
  EXPECT_THAT(csv_complaint("mode,frequency\n1\n", {}), HasSubstr("f.csv:2"));
  EXPECT_THAT(csv_complaint("mode,f\n1,2\n", {}), HasSubstr("no column \"frequency\""));
  EXPECT_THAT(csv_complaint("a,b\n1,2\n", {.columns = {"c"}}),
              HasSubstr("no column \"c\" among a, b"));
  EXPECT_THAT(csv_complaint("a,b\n1,2\n", {.columns = {"a"}, .row = 3}), HasSubstr("row 3"));
  EXPECT_THAT(csv_complaint("", {}), HasSubstr("header"));
}

std::vector<double> frequencies_in(const std::string& text, const FrequencyCells& cells = {}) {
  return parse_frequency_csv(text, "f.csv", cells).frequencies_hz;
}

TEST(CsvFrequencies, AColumnOfModeNumbersPlacesTheFrequencies) {
  using testing::DoubleEq;
  using testing::ElementsAre;
  using testing::IsNan;
  const auto gap = ElementsAre(DoubleEq(0.55), IsNan(), DoubleEq(2.4));
  for (const char* name : {"mode", "number", "Mode"})
    EXPECT_THAT(frequencies_in(std::string(name) + ",frequency [Hz]\n1,0.55\n3,2.4\n"), gap);
  EXPECT_THAT(frequencies_in("mode,frequency [Hz]\n1,0.55\n2,\n3,2.4\n"), gap);
  EXPECT_THAT(frequencies_in("mode;frequency [Hz]\n1;0,55\n2;-\n3;2,4\n"), gap);
  EXPECT_THAT(frequencies_in("frequency [Hz],mode\n0.55,1\nNA,2\n2.4,3\n"), gap);
  EXPECT_THAT(frequencies_in("mode,frequency [Hz]\n2,0.55\n"),
              ElementsAre(IsNan(), DoubleEq(0.55)));
  EXPECT_THAT(frequencies_in("frequency [Hz]\n0.55\nnan\n2.4\n\n"), gap);
  const FrequencyTable table =
      parse_frequency_csv("mode,frequency [kHz],sd [Hz]\n2,0.01,0.1\n", "f.csv", {});
  EXPECT_THAT(table.frequencies_hz, ElementsAre(IsNan(), DoubleEq(10.0)));
  EXPECT_THAT(table.sd_hz, ElementsAre(IsNan(), DoubleEq(0.1)));
}

TEST(CsvFrequencies, UnclearModeNumbersAreErrors) {
  EXPECT_THAT(csv_complaint("mode,frequency\n1,2\n1,3\n", {}),
              HasSubstr("f.csv:3:1: mode 1 follows mode 1: mode numbers must increase"));
  EXPECT_THAT(csv_complaint("mode,frequency\n3,2\n1,3\n", {}), HasSubstr("f.csv:3:1: mode 1"));
  for (const char* mode : {"0", "-1", "1.5", "x", "", "1e300", "20000"})
    EXPECT_THAT(
        csv_complaint("mode,frequency\n" + std::string(mode) + ",2\n", {}),
        HasSubstr("f.csv:2:1: \"" + std::string(mode) + "\": must be the number of a mode"));
  EXPECT_THAT(csv_complaint("frequency [Hz]\n0.55\n\n2.4\n", {}),
              HasSubstr("f.csv:3: empty line between the frequencies: write \"nan\""));
  EXPECT_THAT(csv_complaint("frequency [Hz]\n\n2.4\n", {}), HasSubstr("f.csv:2: empty line"));
  EXPECT_THAT(csv_complaint("frequency [Hz]\n1\n\n2\n\n3\n", {}), HasSubstr("f.csv:3: empty"));
  EXPECT_THAT(csv_complaint("no,frequency\n1,2\n3,4\n", {}),
              HasSubstr("the column \"no\" may hold mode numbers: if so, rename it to \"mode\""));
  EXPECT_THAT(frequencies_in("no,frequency\n1,2\n3,4\n", {.columns = {"frequency"}, .row = 2}),
              testing::ElementsAre(4.0));
  EXPECT_THAT(frequencies_in("name,frequency,damping\na,2,0.01\nb,4,0.01\n"),
              testing::ElementsAre(2.0, 4.0));
  EXPECT_THAT(frequencies_in("# comment\nfrequency\n# comment\n2\n# comment\n4\n"),
              testing::ElementsAre(2.0, 4.0));
}

TEST(CsvFrequencies, SeveralTestsNeedARow) {
  const std::string tests = "f1 [Hz],f2 [Hz]\n1,2\n3,4\n";
  EXPECT_THAT(csv_complaint(tests, {.columns = {"f1", "f2"}}),
              HasSubstr("f.csv:1: has 2 rows: state \"row\", the number of the test, or give the "
                        "tests as \"repeats\""));
  EXPECT_THAT(frequencies_in(tests, {.columns = {"f1", "f2"}, .row = 2}),
              testing::ElementsAre(3.0, 4.0));
  EXPECT_THAT(frequencies_in("f1,f2\n1,2\n", {.columns = {"f1", "f2"}}),
              testing::ElementsAre(1.0, 2.0));
  EXPECT_THAT(csv_complaint("f [Hz]\n1\n2\n", {.columns = {"f [Hz]"}}),
              HasSubstr("if each row is a mode, rename the column to \"frequency [Hz]\""));
}

TEST(CsvFrequencies, AColumnOfFrequenciesNeedsTheKnownName) {
  const auto renamed = [](const std::string& header) {
    return csv_complaint(header + "\n" + (header.find(',') < header.size() ? "1,2\n" : "2\n"), {});
  };
  EXPECT_THAT(renamed("f [Hz]"), HasSubstr("rename the column \"f [Hz]\" to \"frequency [Hz]\""));
  EXPECT_THAT(renamed("f (kHz)"), HasSubstr("to \"frequency [kHz]\""));
  EXPECT_THAT(renamed("w [rad/s]"), HasSubstr("to \"frequency [rad/s]\""));
  EXPECT_THAT(renamed("frequency_hz"), HasSubstr("to \"frequency [Hz]\""));
  EXPECT_THAT(renamed("mode,eigenvalue"), HasSubstr("\"eigenvalue\" to \"frequency [Hz]\""));
  EXPECT_THAT(renamed("temperature,f [Hz]"), HasSubstr("\"f [Hz]\" to \"frequency [Hz]\""));
  EXPECT_THAT(renamed("f1 [Hz],f2 [Hz]"), HasSubstr("data.columns"));
}

TEST(CsvFrequencies, MissingFile) {
  try {
    (void)read_frequency_csv("/no/such.csv", {});
    FAIL();
  } catch (const io::FileError& error) {  // the program's exit code 66
    EXPECT_EQ(error.kind(), io::FileError::Kind::missing);
  }
}

}  // namespace
}  // namespace wheeltap::apps
