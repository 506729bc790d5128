#include "emulator/runs_csv.hpp"

#include <gtest/gtest.h>

#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::emulator {
namespace {

using Kind = io::FileError::Kind;

const std::vector<Factor> kFactors = {{"location[1]", "m", {}}, {"reduction", "", {}}};
constexpr const char* kHeader = "reduction, location[1] [m], f1 [Hz], f2 [Hz]\n";

class RunsCsv : public testing::Test {
 protected:
  Table read(const std::string& text, const std::vector<Factor>& factors = kFactors) const {
    test::put_bytes(path, text);
    return read_runs_csv(path, factors, {.name = "frequency"});
  }
  std::string error(const std::string& text, const std::vector<Factor>& factors = kFactors) const {
    try {
      (void)read(text, factors);
    } catch (const io::FileError& e) {
      EXPECT_EQ(e.kind(), Kind::corrupt);
      return e.reason();
    }
    return "";
  }
  test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "runs.csv";
};

TEST_F(RunsCsv, ReadsColumnsByName) {
  const Table t = read(std::string("# from another code\n") + kHeader +
                       "0.1, 0.25, 13.8, 55.4\r\n\n\"0.3\",0.75,13.1,5.5e1\n");
  ASSERT_EQ(t.points.rows(), 2);
  EXPECT_EQ(t.points(1, 0), 0.75);
  EXPECT_EQ(t.points(1, 1), 0.3);
  EXPECT_EQ(t.values(0, 1), 55.4);
  EXPECT_EQ(t.values(1, 1), 55.0);
  EXPECT_EQ(t.response_unit, "Hz");
  EXPECT_EQ(t.factors[0].unit, "m");
  EXPECT_EQ(t.factors[1].levels, (std::vector{0.1, 0.3}));
}

TEST_F(RunsCsv, ErrorsNameLineAndColumn) {
  const std::string row = "0.1,0.25,13.8,55.4\n";
  EXPECT_NE(error(""), "");
  EXPECT_EQ(error(kHeader), "no runs");
  EXPECT_NE(error("reduction,f1\n0.1,2\n").find("location[1]"), std::string::npos);
  EXPECT_NE(error("reduction,location[1]\n0.1,2\n").find("response"), std::string::npos);
  EXPECT_NE(error("reduction,reduction,location[1],f1\n").find("twice"), std::string::npos);
  EXPECT_NE(error("reduction,location[1] [mm],f1\n").find("mm"), std::string::npos);
  EXPECT_NE(error("reduction,location[1],f1 [Hz],f2 [rad/s]\n").find("units"), std::string::npos);
  for (const char* cell : {"13,8", "nan", "inf", "1e999", "", "13.8Hz", "--1"}) {
    const std::string reason =
        error(std::string(kHeader) + row + "0.2,0.25," + "\"" + cell + "\"" + ",55\n");
    EXPECT_NE(reason.find("line 3"), std::string::npos) << cell;
    EXPECT_NE(reason.find("f1"), std::string::npos) << cell;
  }
  EXPECT_NE(error(std::string(kHeader) + row + "0.2,0.25,13\n").find("3 fields"),
            std::string::npos);
  EXPECT_NE(error(std::string(kHeader) + row + row).find("line 2"), std::string::npos);
  EXPECT_NE(error(std::string(kHeader) + row, {{"location[1]", "m", {0.3, 0.5}}, kFactors[1]})
                .find("outside"),
            std::string::npos);
  EXPECT_NE(error(std::string(kHeader) + row).find("never varies"), std::string::npos);
}

// Runs accept the same delimited text as records.
TEST_F(RunsCsv, AcceptsTheSeparatorsAndUnitsOfRecords) {
  const std::string header = "reduction;location[1] (m);f1 (Hz)\r\n";
  const Table t = parse_runs_csv("\xEF\xBB\xBF" + header + "+0.1;0.25;13.8\r\n0.3;0.75;13.1\r\n",
                                 "runs.csv", kFactors, {.name = "frequency"});
  EXPECT_EQ(t.points(1, 0), 0.75);
  EXPECT_EQ(t.response_unit, "Hz");
  EXPECT_EQ(t.factors[0].unit, "m");
}

// Fault: the order of the columns gave the numbers of the responses, whatever their names.
TEST_F(RunsCsv, NumbersInNamesGiveTheOrderOfResponses) {
  for (const char* const names : {"f3,f1,f2", "f[3],f[1],f[2]", "mode 3,mode 1,mode 2"}) {
    const Table t = read("reduction,location[1]," + std::string(names) +
                         "\n0.1,0.25,30,10,20\n0.3,0.75,31,11,21\n");
    ASSERT_EQ(t.values.cols(), 3) << names;
    EXPECT_EQ(t.values.row(1), (Eigen::RowVector3d(11, 21, 31))) << names;
  }
}

TEST_F(RunsCsv, ResponsesWithoutAClearNumberAreErrors) {
  const auto said = [&](const std::string& names) {
    return error("reduction,location[1]," + names + "\n0.1,0.25,1,2\n0.3,0.75,3,4\n");
  };
  const auto contains = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  contains(said("run,f1"), "\"run\" is neither a factor nor a numbered response");
  contains(said("f1,frequency [Hz]"), "\"frequency [Hz]\" is neither");
  contains(said("f1,run2"), "\"f1\" and \"run2\" have different names");
  contains(said("f1,f3"), "no number 2, but \"f3\"");
  contains(said("f2,f3"), "no number 1");
  contains(said("f1,f01"), "the same response");
  contains(said("f1,f0"), "\"f0\" is neither");
  contains(said("f1,f99999999999"), "number above");
  contains(said("f1 [Hz],f2"), "different units");
}

TEST_F(RunsCsv, ResponsesAreConverted) {
  const auto in_hz = [](const io::Column& column) -> std::optional<double> {
    if (column.unit == "Hz") return 1.0;
    if (column.unit == "kHz") return 1000.0;
    return std::nullopt;
  };
  const ResponseColumns responses = {
      .name = "frequency", .factor = in_hz, .unit = "Hz", .units = "Hz, kHz"};
  const std::string rows = "\n0.1,0.25,2,1\n0.3,0.75,4,3\n";
  const Table t = parse_runs_csv("reduction,location[1],f2 [kHz],f1 [Hz]" + rows, "runs.csv",
                                 kFactors, responses);
  EXPECT_EQ(t.values.row(0), (Eigen::RowVector2d(1, 2000)));
  EXPECT_EQ(t.response_unit, "Hz");
  try {
    (void)parse_runs_csv("reduction,location[1],f1 [Hz],f2 [mm]" + rows, "runs.csv", kFactors,
                         responses);
    FAIL();
  } catch (const io::FileError& e) {
    EXPECT_NE(e.reason().find("\"f2 [mm]\" must be one of Hz, kHz"), std::string::npos);
  }
}

TEST_F(RunsCsv, MissingFile) {
  try {
    (void)read_runs_csv(path, kFactors, {.name = "frequency"});
    FAIL();
  } catch (const io::FileError& e) {
    EXPECT_EQ(e.kind(), Kind::missing);
  }
}

TEST_F(RunsCsv, AFullFactorialInAnyOrderIsAGrid) {
  std::vector<Factor> factors = {{"a", "", {0, 1, 4}}, {"b", "", {2, 3}}};
  Table whole{.factors = factors,
              .points = {},
              .response_name = "f",
              .response_unit = "",
              .values = RowMatrix::Random(6, 2),
              .holdout = {},
              .attributes = {},
              .parameters = {}};
  Table shuffled = whole;
  shuffled.points = whole.design().points;
  for (Eigen::Index i : {1, 3}) {
    shuffled.points.row(i).swap(shuffled.points.row(i + 2));
    shuffled.values.row(i).swap(shuffled.values.row(i + 2));
  }
  const auto grid = as_grid(shuffled);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->is_grid());
  EXPECT_EQ(grid->values, whole.values);
  EXPECT_EQ(grid->factors[0].levels, factors[0].levels);
  shuffled.points(0, 0) = 0.5;
  EXPECT_FALSE(as_grid(shuffled));
}

}  // namespace
}  // namespace wheeltap::emulator
