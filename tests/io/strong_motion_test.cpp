#include "io/formats/strong_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/formats/formats.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io::strong_motion_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPeer =
    "PEER NGA STRONG MOTION DATABASE RECORD\r\n"
    "Valley, 10/15/1979, Array 6, 230\r\n"
    "ACCELERATION TIME SERIES IN UNITS OF G\r\n"
    "NPTS=      7, DT=   .0050 SEC,   \r\n"
    "  .1E-02 -.2E-02  3.0E-03  4.0E-03  5.0E-03\r\n"
    "  6.0E-03  7.0E-03\r\n";

std::string fault(const std::string& text,
                  Columns (*parse)(std::string, const std::filesystem::path&, const Wanted&)) {
  try {
    static_cast<void>(parse(text, "r", {}));
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(StrongMotion, ReadsAPeerRecord) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "R.AT2", kPeer);
  const Columns t = read_columns(directory / "R.AT2");
  ASSERT_EQ(t.columns.size(), 2U);
  EXPECT_EQ(t.columns[0].header, "time [s]");
  EXPECT_DOUBLE_EQ(t.columns[0].values[6], 0.03);
  EXPECT_EQ(t.columns[1].header, "acceleration [g]");
  EXPECT_THAT(t.columns[1].values, ElementsAre(1e-3, -2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3));
}

TEST(StrongMotion, ReadsAnOlderPeerRecordOfVelocity) {
  const Columns t = parse_peer(
      "PACIFIC ENGINEERING\nVALLEY\nVELOCITY TIME HISTORY IN UNITS OF CM/S\n"
      "   4    0.0200    NPTS, DT\n 1.0 2.0\n 3.0 4.0\n",
      "r.vt2", {});
  EXPECT_EQ(t.columns[1].header, "velocity [cm/s]");
  EXPECT_DOUBLE_EQ(t.columns[0].values[1], 0.02);
}

TEST(StrongMotion, RejectsAPeerRecordThatIsTruncatedOrHasNoTimeStep) {
  EXPECT_THAT(fault(kPeer.substr(0, kPeer.size() - 12), parse_peer), HasSubstr("6 of 7 numbers"));
  EXPECT_THAT(fault(kPeer + " 1.0\n", parse_peer), HasSubstr("correct NPTS"));
  EXPECT_THAT(fault("a\nb\n1 2 3\n", parse_peer), HasSubstr("NPTS= 3930, DT= .00500"));
  EXPECT_THAT(fault("a\nNPTS= 1e30, DT= 0.1\n1\n", parse_peer), HasSubstr("line 2"));
}

std::string channel(int number) {
  const std::string n = std::to_string(number);
  return "Corrected accelerogram   89486   Chan  " + n + ": 180 Deg     from\n    1  100 -999\n" +
         " 10 points of accel data equally spaced at 0.010 sec, in cm/sec2. (8f10.5)    \n"
         "   1.00000   2.00000   3.00000   4.00000   5.00000   6.00000-388.16556-999.00000\n"
         "   9.00000  " +
         n +
         "0.00000\n"
         " 10 points of veloc data equally spaced at 0.010 sec, in cm/sec.  (8f10.5)    \n"
         "   0.10000   0.10000   0.10000   0.10000   0.10000   0.10000   0.10000   0.10000\n"
         "   0.10000   0.10000\n"
         "/&  ----------  End of data for channel  " +
         n + "  ----------\n";
}

TEST(StrongMotion, ReadsChannelsOfACsmipRecord) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "ce.v2", channel(1) + channel(2));
  const Columns t = read_columns(directory / "ce.v2");
  ASSERT_EQ(t.columns.size(), 5U);
  EXPECT_EQ(t.columns[1].header, "acceleration, Chan 1: 180 Deg [cm/s^2]");
  EXPECT_EQ(t.columns[4].header, "velocity, Chan 2: 180 Deg [cm/s]");
  EXPECT_EQ(t.columns[1].values[6], -388.16556) << "columns that touch";
  EXPECT_EQ(t.columns[3].values[9], 20.0);
  EXPECT_DOUBLE_EQ(t.columns[0].values[9], 0.09);
  EXPECT_EQ(parse_csmip(channel(1), "r.v2", {}).columns[1].name, "acceleration");
}

TEST(StrongMotion, RejectsInvalidCsmipRecords) {
  EXPECT_THAT(fault("a,b\n1,2\n", parse_csmip), HasSubstr("volume 2"));
  EXPECT_THAT(fault(channel(1).substr(0, channel(1).find("9.00000  1")), parse_csmip),
              HasSubstr("truncated"));
  EXPECT_THAT(fault(" x points of accel data equally spaced at -1 sec\n", parse_csmip),
              HasSubstr("line 1"));
}

}  // namespace
}  // namespace wheeltap::io::strong_motion_test
