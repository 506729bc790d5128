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
