#include "signals/record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace {

using namespace wheeltap;
using namespace wheeltap::signals;
using Kind = io::FileError::Kind;
namespace fs = std::filesystem;

/// A file used by the test.
class RecordFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("wheeltap_record_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
               std::to_string(std::hash<std::string>{}(fs::current_path().string())));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text) {
    const fs::path path = folder_ / "r.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  fs::path folder_;
};

/// The message of an error in a file's content.
std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const io::FileError& error) {
    EXPECT_EQ(error.kind(), Kind::corrupt);
    return error.what();
  }
  return "(nothing thrown)";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(RecordFile, ReadsHeadersWithUnits) {
  const Record r =
      read_record(write("# a comment\r\ntime [s],force [N],\"tip "
                        "(mm)\"\r\n0.00,1,-2e-3\r\n0.01,+2,nan\r\n0.02,3,\r\n\r\n"));
  ASSERT_EQ(r.columns.size(), 3U);
  ASSERT_EQ(r.samples(), 3);
  EXPECT_EQ(r.columns[1].name, "force");
  EXPECT_EQ(r.columns[1].unit, "N");
  EXPECT_EQ(r.columns[2].name, "tip");
  EXPECT_EQ(r.columns[2].unit, "mm");
  EXPECT_EQ(r.columns[1].values, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(r.columns[2].values[0], -2e-3);
  EXPECT_TRUE(std::isnan(r.columns[2].values[1]));
  EXPECT_TRUE(std::isnan(r.columns[2].values[2]));
  EXPECT_EQ(r.find("force [N]"), 1);
  EXPECT_EQ(r.find("force"), 1);
  EXPECT_EQ(r.find("2"), 1);
  EXPECT_EQ(r.find_time(), 0);
  EXPECT_NEAR(sample_rate_hz(r, 0), 100.0, 1e-9);
  EXPECT_TRUE(contains(message([&] { (void)r.find("velocity"); }), "'force [N]'"));
  EXPECT_THROW((void)r.find("4"), io::FileError);
}

TEST_F(RecordFile, ReadsDecimalCommas) {
  EXPECT_EQ(read_record(write("a;b\n0;1,5\n")).columns[1].values.front(), 1.5);
}

TEST_F(RecordFile, NumbersColumnsWithoutHeader) {
  const Record r = read_record(write("0\t1.5\n1\t2.5\n"));
  ASSERT_EQ(r.samples(), 2);
  EXPECT_EQ(r.columns[1].header, "2");
  EXPECT_EQ(r.find("2"), 1);
  EXPECT_EQ(r.first_line, 1);
  EXPECT_EQ(r.find_time(), -1);
}

TEST_F(RecordFile, ErrorsNameFileLineAndColumn) {
  std::string what = message([&] { (void)read_record(write("t,x\n0,1\n1\n")); });
  EXPECT_TRUE(contains(what, "r.csv, line 3: 1 columns, must be 2")) << what;
  what = message([&] { (void)read_record(write("t,x\n0,1\n1,2,3\n")); });
  EXPECT_TRUE(contains(what, "line 3: 3 columns")) << what;
  what = message([&] { (void)read_record(write("t,x\n0,1\n1,2.5.1\n")); });
  EXPECT_TRUE(contains(what, "line 3, column 2 ('x'): '2.5.1' is not a number")) << what;
  what = message([&] { (void)read_record(write("t,x\n0,1\n\n1,2\n")); });
  EXPECT_TRUE(contains(what, "line 3: empty line")) << what;
  EXPECT_THROW((void)read_record(write("")), io::FileError);
  EXPECT_THROW((void)read_record(write("t,x\n")), io::FileError);
  EXPECT_THROW((void)read_record(folder_ / "missing.csv"), io::FileError);
  EXPECT_THROW((void)read_record(folder_), io::FileError);
}

TEST_F(RecordFile, TimeMustBeUniform) {
  const auto rate = [&](const std::string& times, std::optional<double> stated = std::nullopt) {
    const Record r = read_record(write("time [s]\n" + times));
    return sample_rate_hz(r, 0, stated);
  };
  EXPECT_NEAR(rate("0\n0.5\n1\n1.5\n", 2.0), 2.0, 1e-12);
  // 1/64 s printed with five digits.
  EXPECT_NEAR(rate("0\n0.015625\n0.03125\n0.046875\n"), 64.0, 1e-9);
  EXPECT_NEAR(rate("10.984\n11\n11.016\n11.031\n11.047\n", 64.0), 63.49, 0.01);
  std::string what = message([&] { (void)rate("0\n0.5\nnan\n1.5\n"); });
  EXPECT_TRUE(contains(what, "line 4, column 1 ('time [s]'): time is not a finite number")) << what;
  what = message([&] { (void)rate("0.0\n0.5\n1.0\n2.0\n2.5\n3.0\n"); });  // a gap
  EXPECT_TRUE(contains(what, "line 5, column 1 ('time [s]'): time goes from 1 to 2 s")) << what;
  what = message([&] { (void)rate("0.00\n0.50\n1.02\n1.50\n2.00\n"); });
  EXPECT_TRUE(contains(what, "line 4")) << what;
  EXPECT_THROW((void)rate("0.0\n0.5\n0.4\n1.5\n"), io::FileError);
  EXPECT_THROW((void)rate("3\n2\n1\n"), io::FileError);
  EXPECT_THROW((void)rate("3\n"), io::FileError);
  what = message([&] { (void)rate("0.000\n0.500\n1.000\n1.500\n", 2.1); });
  EXPECT_TRUE(contains(what, "states 2 Hz, which contradicts the stated sampling rate of 2.1 Hz"))
      << what;
}

TEST_F(RecordFile, WindowsMustLieInTheRecordAndBeFinite) {
  const Record r = read_record(write("x\n1\n2\nnan\n4\n5\n"));
  EXPECT_EQ(window(r, 0, 3, 5), (std::vector<double>{4, 5}));
  EXPECT_TRUE(contains(message([&] { (void)window(r, 0, 1, 4); }), "line 4, column 1"));
  EXPECT_TRUE(contains(message([&] { (void)window(r, 0, 3, 6); }), "within [0, 5)"));
  EXPECT_THROW((void)window(r, 0, 3, 3), io::FileError);
  EXPECT_THROW((void)window(r, 0, -1, 3), io::FileError);
}

// Regression: a tone above half of a lower rate appeared at a lower frequency.
TEST_F(RecordFile, ResamplingToALowerRateDoesNotAlias) {
  std::string text = "time [s],slow,fast\n";
  for (int n = 0; n < 4000; ++n) {
    const double t = (n + 0.2 * std::sin(0.7 * n)) / 1000.0;
    char line[100];
    std::snprintf(line, sizeof line, "%.9f,%.9f,%.9f\n", t, std::sin(2.0 * M_PI * 5.0 * t),
                  std::sin(2.0 * M_PI * 90.0 * t));
    text += line;
  }
  const Record r = resampled(read_record(write(text)), 0, 100.0);
  ASSERT_NEAR(static_cast<double>(r.columns[1].values.size()), 400.0, 1.0);
  for (std::size_t n = 50; n < 350; ++n) {
    EXPECT_NEAR(r.columns[1].values[n], std::sin(2.0 * M_PI * 5.0 * 0.01 * static_cast<double>(n)),
                1e-3);
    EXPECT_NEAR(r.columns[2].values[n], 0.0, 1e-3);
  }
}

// A clock that is slightly fast is no lower rate: nothing is filtered.
TEST_F(RecordFile, ResamplingToTheNominalRateKeepsAllFrequencies) {
  std::string text = "time [s],x\n";
  for (int n = 0; n < 400; ++n) {
    char line[100];
    std::snprintf(line, sizeof line, "%.9f,%.9f\n", n / 100.005, std::sin(0.9 * M_PI * n));
    text += line;
  }
  const Record r = resampled(read_record(write(text)), 0, 100.0);
  double largest = 0.0;
  for (std::size_t n = 100; n < 300; ++n)
    largest = std::max(largest, std::abs(r.columns[1].values[n]));
  EXPECT_GT(largest, 0.9);
}

// Regression: "time [ms]" was read as seconds.
TEST_F(RecordFile, TimeInMillisecondsIsNotReadAsSeconds) {
  const auto rate = [&](const std::string& header, std::optional<double> stated = std::nullopt,
                        std::optional<double> scale = std::nullopt) {
    const Record r = read_record(write(header + "\n0\n5\n10\n15\n"));
    return sample_rate_hz(r, 0, stated, scale);
  };
  EXPECT_DOUBLE_EQ(rate("time [ms]"), 200.0);
  EXPECT_DOUBLE_EQ(rate("time (µs)"), 200e3);
  EXPECT_DOUBLE_EQ(rate("t[us]"), 200e3);
  EXPECT_DOUBLE_EQ(rate("Time [min]"), 1.0 / 300.0);
  EXPECT_DOUBLE_EQ(rate("time [s]"), 0.2);
  EXPECT_DOUBLE_EQ(rate("time"), 0.2);
  EXPECT_DOUBLE_EQ(rate("time [ms]", 200.0), 200.0);
  EXPECT_DOUBLE_EQ(rate("time [ms]", std::nullopt, 1e-6), 200e3) << "a stated scale wins";
  EXPECT_DOUBLE_EQ(rate("time [ticks]", std::nullopt, 1e-3), 200.0);
  EXPECT_TRUE(contains(message([&] { (void)rate("time [ms]", 0.2); }), "states 200 Hz"));
  for (const char* unit : {"ticks", "V", "mm", "1"}) {
    const std::string what = message([&] { (void)rate("time [" + std::string(unit) + "]"); });
    EXPECT_TRUE(contains(what, "column 1 ('time [" + std::string(unit) + "]'): time is in '" +
                                   unit + "', must be one of s, ms, us, ns, min, h, d"))
        << what;
  }
}

// Regression: a fit of a short window read every cell of a record, including columns that no
// channel names. The test uses text in columns that must not be read.
TEST_F(RecordFile, ReadsOnlyRequestedColumns) {
  std::string text = "time [s],remark,force [N],x [m]\n";
  for (int n = 0; n < 1000; ++n)
    text += std::to_string(n) + ",at " + std::to_string(n) + "," + std::to_string(2 * n) + ",1\n";
  const auto path = write(text);
  const Record r = read_record(path, {.columns = {"force"}});
  EXPECT_EQ(r.samples(), 1000);
  EXPECT_EQ(window(r, r.find("force"), 2, 4), (std::vector<double>{4, 6}));
  EXPECT_EQ(sample_rate_hz(r, r.find_time()), 1.0) << "time is always read";
  EXPECT_TRUE(r.columns[1].values.empty());
  EXPECT_THROW((void)window(r, r.find("x"), 2, 4), std::invalid_argument);
  EXPECT_TRUE(contains(message([&] { (void)read_record(path); }), "line 2, column 2 ('remark')"));
  EXPECT_EQ(read_record(path, {.columns = {"4"}}).columns[3].values.size(), 1000U)
      << "by its number";
}

TEST_F(RecordFile, ReadsARecordInACustomFormat) {
  std::vector<io::Format> known(io::formats().begin(), io::formats().end());
  known.push_back({.name = "count",
                   .endings = {".count"},
                   .parse = [](std::string bytes, const fs::path& name, const io::Wanted&) {
                     io::Columns table{.file = name.string(),
                                       .columns = {io::column_of_header("byte")}};
                     for (const char c : bytes) table.columns[0].values.push_back(c);
                     return table;
                   }});
  std::ofstream(folder_ / "r.count") << "abc";
  const Record r = read_record(folder_ / "r.count", {}, known);
  EXPECT_EQ(window(r, r.find("byte"), 0, 3), (std::vector<double>{'a', 'b', 'c'}));
  EXPECT_THROW((void)read_record(folder_ / "r.count"), io::FileError);
}

// The measured data sets next to the repository.
class SharedData : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
  }
  const fs::path folder_ = fs::path(WHEELTAP_SHARED_DIR) / "data";
};

TEST_F(SharedData, ShakeTableFrame) {
  const Record r = read_record(folder_ / "shake-table-3storey-frame/fixed_base_gm152s1.csv");
  EXPECT_EQ(r.samples(), 11050);
  EXPECT_NEAR(sample_rate_hz(r, r.find_time(), 256.0), 256.0, 1e-3);
  double peak = 0.0;
  for (double a : window(r, r.find("table_accel_g"), 0, r.samples()))
    peak = std::max(peak, std::abs(a));
  EXPECT_NEAR(peak, 0.230, 5e-4);  // the set's README
}

TEST_F(SharedData, FrictionDamper) {
  const Record r = read_record(folder_ / "friction-damper-backlash/ds2_2Hz_30lb_0.5in.csv");
  EXPECT_EQ(r.samples(), 3585);
  EXPECT_NEAR(sample_rate_hz(r, r.find_time(), 1024.0), 1024.0, 0.1);
}

TEST_F(SharedData, BistableX) {
  const Record csv = read_record(
      folder_ /
      "bistablex/base_rotation_phi=0/single_freq/freq_6.3Hz/mag_vr=0_vl=0/amplitude_25mV.csv");
  ASSERT_EQ(csv.columns.size(), 6U);
  EXPECT_NEAR(sample_rate_hz(csv, 0, 64.0), 64.0, 0.05);  // time printed with five digits
  EXPECT_THROW(                                           // complex numbers as text
      (void)read_record(folder_ /
                        "bistablex/base_rotation_phi=0/swept_sine/mag_vr=0_vl=0/left_eq_point.csv"),
      io::FileError);
  Record mat;
  try {
    mat = read_record(folder_ / "bistablex/poincare_analysis/chaos_symmetric/DPsv00001.mat");
  } catch (const io::FileError& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(mat.samples(), 8192);
  EXPECT_NEAR(sample_rate_hz(mat, mat.find("X1(:,1)")), 2048.0, 1e-3);
  const Record mono = read_record(folder_ /
                                  "bistablex/poincare_analysis/mono_symmetric/"
                                  "mono_left_symmetric/DPsv00001.mat");
  EXPECT_NEAR(sample_rate_hz(mono, mono.find("X1(:,1)")), 2560.0, 1e-3);
}

TEST_F(SharedData, SilverboxInBothFormats) {
  const Record csv = read_record(folder_ / "silverbox/snls80mv_multisine_train.csv");
  ASSERT_EQ(csv.samples(), 40000);
  Record mat;
  try {
    mat = read_record(folder_ / "silverbox/snls80mv_multisine_train_v5.mat");
  } catch (const io::FileError& error) {
    GTEST_SKIP() << error.what();
  }
  ASSERT_EQ(mat.samples(), 40000);
  EXPECT_NEAR(mat.scalars.at("fs_Hz"), 610.35, 0.01);
  EXPECT_EQ(mat.scalars.at("first_index"), 40650.0);
  for (const auto& [in_mat, in_csv] :
       {std::pair{"V1", "V1_input_V"}, std::pair{"V2", "V2_output_V"}}) {
    const std::vector<double> a = window(mat, mat.find(in_mat), 0, 40000);
    const std::vector<double> b = window(csv, csv.find(in_csv), 0, 40000);
    for (std::size_t n = 0; n < a.size(); ++n) ASSERT_NEAR(a[n], b[n], 1e-9 * std::abs(b[n]));
  }
}

}  // namespace
