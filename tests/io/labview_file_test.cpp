#include "io/formats/labview_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace wheeltap::io::labview_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string header(const std::string& x_columns, const std::string& more = "") {
  return "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\n"
         "Decimal_Separator\t.\r\nMulti_Headings\tNo\r\nX_Columns\t" +
         x_columns + "\r\nTime_Pref\tAbsolute\r\n" + more + "***End_of_Header***\t\r\n\t\r\n";
}

const std::string kSegment =
    "Channels\t2\t\t\r\nSamples\t3\t3\t\r\nDate\t2026/01/01\t2026/01/01\t\r\n"
    "Y_Unit_Label\tm/s^2\tN\t\r\nX0\t5.0E-1\t5.0E-1\t\r\nDelta_X\t0.25\t0.25\t\r\n"
    "***End_of_Header***\t\t\t\r\nX_Value\tacceleration\tforce\tComment\r\n";

/// A segment with a wrong number of samples in its header.
std::string segment_of(int samples) {
  std::string text = kSegment;
  const std::string n = std::to_string(samples);
  return text.replace(text.find("Samples\t3\t3"), 11, "Samples\t" + n + "\t" + n);
}

Columns parsed(const std::string& text) {
  return parse_labview(text, "run.lvm", {});
}

std::string fault(const std::string& text) {
  try {
    parsed(text);
  } catch (const FileError& e) {
    return e.what();
  }
  return "nothing thrown";
}

TEST(LabviewFile, OneTimeColumn) {
  const Columns c = parsed(header("One") + kSegment +
                           "0.50\t1.5\t-2\tstart\r\n0.75\t1.25e1\t3\r\n1.00\t-1\t\t\r\n");
  ASSERT_EQ(c.columns.size(), 3U);
  EXPECT_EQ(c.columns[1].header, "acceleration [m/s^2]");
  EXPECT_EQ(c.columns[2].unit, "N");
  EXPECT_THAT(c.columns[0].values, ElementsAre(0.5, 0.75, 1.0));
  EXPECT_THAT(c.columns[1].values, ElementsAre(1.5, 12.5, -1.0));
  EXPECT_TRUE(std::isnan(c.columns[2].values[2]));
}

TEST(LabviewFile, Latin1BecomesUtf8) {
  std::string segment = kSegment;
  segment.replace(segment.find("m/s^2"), 5, "m/s\xb2");
  segment.replace(segment.find("force"), 5,
                  "Kr\xe4"
                  "fte");
  const Columns c =
      parsed(header("One") + segment + "0.50\t1.5\t-2\r\n0.75\t1.25e1\t3\r\n1.00\t-1\t2\r\n");
  ASSERT_EQ(c.columns.size(), 3U);
  EXPECT_EQ(c.columns[1].unit, "m/s²");
  EXPECT_EQ(c.columns[2].name, "Kräfte");
}

TEST(LabviewFile, ComputesTimeWithoutATimeColumn) {
  const Columns c = parsed(header("No") + kSegment + "\t1\t2\r\n\t3\t4\r\n\t5\t6\r\n");
  EXPECT_THAT(c.columns[0].values, ElementsAre(0.5, 0.75, 1.0));
  EXPECT_THAT(c.columns[2].values, ElementsAre(2.0, 4.0, 6.0));
}

TEST(LabviewFile, ATimeForEachChannel) {
  std::string segment = segment_of(2);
  segment.replace(segment.find("X_Value"), std::string::npos,
                  "X_Value\tacceleration\tX_Value\tforce\tComment\r\n");
  const Columns c = parsed(header("Multi") + segment + "0.5\t1\t0.5\t2\r\n0.75\t3\t0.75\t4\r\n");
  EXPECT_THAT(c.columns[2].values, ElementsAre(2.0, 4.0));
  EXPECT_EQ(c.columns[2].name, "force");
  EXPECT_THAT(fault(header("Multi") + segment + "0.5\t1\t0.6\t2\r\n"),
              HasSubstr("different times"));
}

TEST(LabviewFile, AppendsSegments) {
  const Columns c =
      parsed(header("No") + segment_of(1) + "\t1\t2\r\n\r\n" + segment_of(1) + "\t3\t4\r\n");
  EXPECT_THAT(c.columns[1].values, ElementsAre(1.0, 3.0));
}

TEST(LabviewFile, DecimalCommas) {
  std::string text = header("One") + segment_of(1) + "0,50\t1,5\t-2\r\n";
  text.replace(text.find("Decimal_Separator\t."), 19, "Decimal_Separator\t,");
  text.replace(text.find("0.25\t0.25"), 9, "0,25\t0,25");
  text.replace(text.find("5.0E-1\t5.0E-1"), 13, "5,0E-1\t5,0E-1");
  EXPECT_THAT(parsed(text).columns[1].values, ElementsAre(1.5));
}

TEST(LabviewFile, ReportsErrorsWithTheirLines) {
  EXPECT_THAT(fault("Labview\n"), HasSubstr("does not begin with"));
  EXPECT_THAT(fault(header("One").substr(0, 60)), HasSubstr("ends within its header"));
  EXPECT_THAT(fault(header("One")), HasSubstr("no segment"));
  EXPECT_THAT(fault(header("One") + kSegment + "0.5\t1\tx\r\n"),
              HasSubstr("line 19: \"x\" is not a number"));
  EXPECT_THAT(fault(header("One") + kSegment + "0.5\t1\r\n"), HasSubstr("must have 3"));
  EXPECT_THAT(fault(header("One") + kSegment + "0.5\t1\t2\r\n0.75\t1\t2\r\n"),
              HasSubstr("only 2 of 3 samples are there"));
  std::string absurd = segment_of(1);
  absurd.replace(absurd.find("Samples\t1"), 9, "Samples\t1e300");
  EXPECT_THAT(fault(header("One") + absurd + "0.5\t1\t2\r\n"), HasSubstr("must be a whole number"));
  std::string segment = kSegment;
  segment.replace(segment.find("Channels\t2"), 10, "Channels\t2e9");
  EXPECT_THAT(fault(header("One") + segment), HasSubstr("must be a whole number"));
  EXPECT_THAT(fault(header("One") + kSegment.substr(kSegment.find("Samples"))),
              HasSubstr("Channels"));
}

}  // namespace
}  // namespace wheeltap::io::labview_file_test
