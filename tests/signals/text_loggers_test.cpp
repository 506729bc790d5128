// Texts in the formats of loggers, programs and countries: read correctly, or rejected with a
// remedy. The numbers are generated here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "io/formats/labview_file.hpp"
#include "io/tables/delimited_text.hpp"
#include "signals/record.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {
namespace {

using testing::HasSubstr;

constexpr int kRows = 12;

double value(int channel, int row) {
  return channel + 0.125 * row * (row % 2 == 0 ? 1 : -1);
}

std::string with_mark(std::string text, char decimal) {
  for (char& c : text)
    if (c == '.') c = decimal;
  return text;
}

std::string number(double x, char decimal = '.', const char* format = "%.3f") {
  char text[64];
  // The layout of a text in this test.
  std::snprintf(text, sizeof text, format, x);
  return with_mark(text, decimal);
}

struct Style {
  std::string separator = ",";
  char decimal = '.';
  std::string before = "", after = "";  ///< text around each number
  std::string end = "\n";
  const char* format = "%.3f";
};

/// Rows of a time, if there is one, and `channels` numbers.
std::string rows(int channels, const Style& style = {},
                 const std::function<std::string(int)>& time = {}) {
  std::string out;
  for (int n = 0; n < kRows; ++n) {
    std::string line = time ? time(n) : "";
    for (int c = 0; c < channels; ++c) {
      if (c > 0 || time) line += style.separator;
      line += style.before + number(value(c, n), style.decimal, style.format) + style.after;
    }
    out += line + style.end;
  }
  return out;
}

/// Seconds in steps of 0.01.
std::function<std::string(int)> seconds(char decimal = '.', const char* format = "%.2f") {
  return [=](int n) { return number(0.01 * n, decimal, format); };
}

/// "…00.010": a stamp whose seconds have three decimals.
std::function<std::string(int)> stamps(const std::string& before, const std::string& after = "",
                                       char mark = '.') {
  return [=](int n) { return before + number(0.01 * n, mark, "%06.3f") + after; };
}

struct Channel {
  std::string name, unit;
};

Record parsed(const std::string& text, const io::TextLayout& layout = {}) {
  const io::Wanted no_texts = [](const io::Columns& table, std::size_t c) {
    return table.columns[c].cells != io::CellKind::text;
  };
  return Record{io::parse_delimited_text(text, "log.csv", no_texts, layout)};
}

/// Columns that hold numbers other than time.
void expect_channels(const Record& r, const std::vector<Channel>& channels) {
  const int time = r.find_time();
  std::size_t found = 0;
  for (std::size_t i = 0; i < r.columns.size(); ++i) {
    const io::Column& column = r.columns[i];
    if (static_cast<int>(i) == time || column.values.empty() ||
        column.cells != io::CellKind::number)
      continue;
    ASSERT_LT(found, channels.size()) << column.header;
    EXPECT_EQ(column.name, channels[found].name);
    EXPECT_EQ(unit_of(column), channels[found].unit) << column.header;
    ASSERT_EQ(std::ssize(column.values), kRows);
    for (int n = 0; n < kRows; ++n)
      EXPECT_EQ(column.values[static_cast<std::size_t>(n)], value(static_cast<int>(found), n))
          << column.header << " " << n;
    ++found;
  }
  EXPECT_EQ(found, channels.size());
}

/// At 100 Hz.
Record expect_read(const std::string& text, const std::vector<Channel>& channels,
                   const io::TextLayout& layout = {}) {
  const Record r = parsed(text, layout);
  expect_channels(r, channels);
  const int time = r.find_time();
  if (time >= 0) {
    EXPECT_NEAR(sampling_of(r, time).rate_hz, 100.0, 5e-3);
  } else {
    const std::optional<Sampling> said = sampling_from_header(r);
    EXPECT_TRUE(said.has_value());
    EXPECT_NEAR(said.value_or(Sampling{}).rate_hz, 100.0, 1e-9);
  }
  return r;
}

std::string refusal(const std::string& text, const io::TextLayout& layout = {}) {
  try {
    const Record r = parsed(text, layout);
    if (const int time = r.find_time(); time >= 0) (void)sampling_of(r, time);
  } catch (const io::FileError& error) {
    return error.what();
  }
  return "nothing thrown";
}

const Style kGerman = {.separator = ";", .decimal = ','};
const Style kTabs = {.separator = "\t"};

// ---- loggers ---------------------------------------------------------------------------------

TEST(TextLoggers, CampbellToa5) {
  const Record r = expect_read(
      "\"TOA5\",\"Bridge\",\"CR6\",\"1\",\"CR6.Std.09\",\"CPU:a.CR6\",\"5\",\"Acc\"\n"
      "\"TIMESTAMP\",\"Acc1\",\"Acc2\"\n\"TS\",\"g\",\"m/s^2\"\n\"\",\"Smp\",\"Smp\"\n" +
          rows(2, {}, stamps("\"2021-03-01 10:00:", "\"")),
      {{"Acc1", "g"}, {"Acc2", "m/s^2"}});
  EXPECT_EQ(r.layout->used.header, 2);
  EXPECT_EQ(r.layout->used.units_row, 3);
}

TEST(TextLoggers, CampbellToa5WithMissingValues) {
  std::string text =
      "\"TOA5\",\"B\",\"CR6\",\"1\",\"S\",\"C\",\"5\",\"A\"\n\"TIMESTAMP\",\"RECORD\",\"Acc1\"\n"
      "\"TS\",\"RN\",\"g\"\n\"\",\"\",\"Smp\"\n";
  for (int n = 0; n < kRows; ++n)
    text += "\"2021-03-01 10:00:" + number(0.01 * n, '.', "%05.2f") + "\"," + std::to_string(n) +
            (n == 3 ? ",\"NAN\"\n" : ",0.5\n");
  const Record r = parsed(text);
  EXPECT_TRUE(std::isnan(r.columns[2].values[3]));
  EXPECT_EQ(r.columns[2].values[4], 0.5);
}

TEST(TextLoggers, DewesoftExport) {
  expect_read(
      "File name\t: test.dxd\nSample rate\t: 100.0\nStart time\t: 2021-03-01 10:00:00\n\n"
      "Time (s)\tAI 1 (g)\tAI 2 (mm/s)\n" +
          rows(2, kTabs, seconds()),
      {{"AI 1", "g"}, {"AI 2", "mm/s"}});
}

TEST(TextLoggers, CatmanAsciiInGerman) {
  expect_read(
      "Messung: Br\xfc"
      "cke\nMessdatum: 01.03.2021\nKan\xe4le: 3\n\n"
      "Zeit\tKraft\tWeg\ns\tkN\t\xb5m\n" +
          rows(2, {.separator = "\t", .decimal = ','}, seconds(',')),
      {{"Kraft", "kN"}, {"Weg", "µm"}});
}

TEST(TextLoggers, ImcWithUnitsInBrackets) {
  expect_read(
      "Zeit;Beschl. 1;Beschl. 2\n[s];[m/s\xb2];[m/s\xb2]\n" + rows(2, kGerman, seconds(',')),
      {{"Beschl. 1", "m/s²"}, {"Beschl. 2", "m/s²"}});
}

TEST(TextLoggers, UnitsRowWithItsOwnLabel) {
  expect_read("Name;Zeit;a1;a2\nEinheit;s;g;g\n" +
                  rows(2, kGerman, [](int n) { return ";" + seconds(',')(n); }),
              {{"a1", "g"}, {"a2", "g"}});
}

TEST(TextLoggers, GulfCoastDataConceptsComments) {
  expect_read(
      ";Title, X16\n;Version, 1.0\n;Start_time, 2021-03-01, 10:00:00.000\n"
      ";SampleRate, 100,Hz\n;Headers, time,Ax,Ay\n" +
          rows(2, {}, seconds()),
      {{"Ax", ""}, {"Ay", ""}});
}

TEST(TextLoggers, PhoneWithTrailingSeparator) {
  expect_read("Time (s),X-Axis (m/s2),Z-Axis (m/s2)\n" + rows(2, {.end = ",\n"}, seconds()),
              {{"X-Axis", "m/s2"}, {"Z-Axis", "m/s2"}});
}

TEST(TextLoggers, Phyphox) {
  expect_read("\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\"\n" +
                  rows(2, {.format = "%.9E"}, seconds('.', "%.9E")),
              {{"Acceleration x", "m/s^2"}, {"Acceleration y", "m/s^2"}});
  expect_read(
      "\"Time (s)\";\"Acceleration x (m/s^2)\"\n" +
          rows(1, {.separator = ";", .decimal = ',', .format = "%.9E"}, seconds(',', "%.9E")),
      {{"Acceleration x", "m/s^2"}});
}

TEST(TextLoggers, SensorLoggerEpochNanoseconds) {
  expect_read(
      "time,z,y\n" + rows(2, {},
                          [](int n) {
                            return std::to_string(1'614'592'800'000'000'000LL + 10'000'000LL * n);
                          }),
      {{"z", ""}, {"y", ""}});
}

TEST(TextLoggers, ArduinoWithMillis) {
  expect_read("Starting\nSensor found\nmillis,ax,ay\n" +
                  rows(2, {.end = "\r\n"}, [](int n) { return std::to_string(4711 + 10 * n); }),
              {{"ax", ""}, {"ay", ""}});
  expect_read(
      "Time_us\tax [mg]\n" + rows(1, kTabs, [](int n) { return std::to_string(99 + 10000 * n); }),
      {{"ax", "mg"}});
}

TEST(TextLoggers, ClockTimesOverMidnight) {
  expect_read(
      "Date,Time,a [g]\n" + rows(1, {},
                                 [](int n) {
                                   return n < 6 ? "2021-03-01,23:59:59." + std::to_string(94 + n)
                                                : "2021-03-02,00:00:00.0" + std::to_string(n - 6);
                                 }),
      {{"a", "g"}});
}

TEST(TextLoggers, StatusAndRemarksAreNotChannels) {
  std::string text = "time [s]\ta [g]\tStatus\tComment\n";
  for (int n = 0; n < kRows; ++n)
    text += seconds()(n) + "\t" + number(value(0, n)) + "\tOK\t" + (n == 0 ? "start" : "") + "\n";
  expect_read(text, {{"a", "g"}});
  text = "time [s]\ta [g]\tComment\n";
  for (int n = 0; n < kRows; ++n)
    text += seconds()(n) + "\t" + number(value(0, n)) + (n == 0 ? "\tstart" : "") + "\n";
  expect_read(text, {{"a", "g"}});
}

TEST(TextLoggers, RemarksAfterTheRows) {
  const Record r =
      expect_read("time [s],a [g]\n" + rows(1, {}, seconds()) + "\nEnd of measurement\nMax: 1.5\n",
                  {{"a", "g"}});
  EXPECT_EQ(r.layout->tail_to, kRows + 4);
}

TEST(TextLoggers, WordsForMissingValues) {
  for (const std::string word : {"NAN", "-", "---", "#N/A", "#NV", "#DIV/0!", "****", "Overload",
                                 "No Data", "", "NULL", "1.#QNAN"}) {
    const Record r = parsed("time [s],a [g]\n0,1\n0.01," + word + "\n0.02,3\n");
    ASSERT_EQ(r.samples(), 3) << word;
    EXPECT_TRUE(std::isnan(r.columns[1].values[1])) << word;
    EXPECT_EQ(r.columns[1].values[2], 3.0) << word;
  }
  EXPECT_THAT(refusal("time [s],a [g]\n0,1\n0.01,x\n0.02,3\n"), HasSubstr("\"role\": \"ignore\""));
}

// ---- oscilloscopes and analysers -------------------------------------------------------------

TEST(TextLoggers, PicoScopeWithUnitsRow) {
  expect_read("Time,Channel A,Channel B\n(ms),(V),(mV)\n\n" +
                  rows(2, {}, [](int n) { return number(10.0 * n - 50.0, '.', "%.5f"); }),
              {{"Channel A", "V"}, {"Channel B", "mV"}});
}

TEST(TextLoggers, TektronixHeaderLines) {
  expect_read(
      "Model,DPO4034\nFirmware Version,2.68\n\nSample Interval,1.00000e-02,s\n"
      "Vertical Units,V,V\n\nTIME,CH1,CH2\n" +
          rows(2, {}, seconds('.', "%.5e")),
      {{"CH1", ""}, {"CH2", ""}});
}

TEST(TextLoggers, KeysightAxisAndUnits) {
  expect_read(
      "x-axis,1,2\nsecond,Volt,Volt\n" + rows(2, {.format = "%+.5E"}, seconds('.', "%+.5E")),
      {{"1", "Volt"}, {"2", "Volt"}});
}

// ---- programs --------------------------------------------------------------------------------

TEST(TextLoggers, MatlabWritetable) {
  expect_read("t,acc_1,acc_2\n" + rows(2, {}, seconds()), {{"acc_1", ""}, {"acc_2", ""}});
  expect_read("Time,a\n" + rows(1, {}, stamps("01-Mar-2021 10:00:")), {{"a", ""}});
}

TEST(TextLoggers, ComsolPercentComments) {
  expect_read("% Model: beam\n% Dimension: 1\n% t (s)    acc (m/s^2)\n" +
                  rows(1, {.separator = "   "}, seconds()),
              {{"acc", "m/s^2"}});
}

TEST(TextLoggers, NumpySavetxt) {
  expect_read("# t [s] a [g] b [g]\n" +
                  rows(2, {.separator = " ", .format = "%.18e"}, seconds('.', "%.18e")),
              {{"a", "g"}, {"b", "g"}});
}

TEST(TextLoggers, PandasWithAnIndex) {
  const Record r = parsed(",time [s],a [g]\n0,0.00,1\n1,0.01,2\n2,0.02,4\n");
  EXPECT_EQ(r.columns[0].name, "1");
  EXPECT_EQ(r.find_time(), 1);
  EXPECT_EQ(r.columns[2].unit, "g");
}

TEST(TextLoggers, RWithRowNames) {
  const Record r = parsed("\"time\",\"a\"\n\"1\",0.00,1\n\"2\",0.01,2\n\"3\",0.02,4\n");
  ASSERT_EQ(r.columns.size(), 3U);
  EXPECT_EQ(r.columns[2].name, "a");
  EXPECT_EQ(r.columns[2].values, (std::vector<double>{1, 2, 4}));
}

TEST(TextLoggers, OctaveTextMatrix) {
  const Record r =
      parsed("# Created by Octave\n# name: x\n# type: matrix\n# rows: 12\n# columns: 2\n" +
             rows(1, {.separator = " "}, [](int n) { return " " + seconds()(n); }));
  expect_channels(r, {{"2", ""}});
}

TEST(TextLoggers, FortranExponents) {
  std::string text = "time [s] a [g]\n" + rows(1, {.separator = "  ", .format = "%.6E"}, seconds());
  for (char& c : text)
    if (c == 'E') c = 'D';
  expect_read(text, {{"a", "g"}});
}

TEST(TextLoggers, SampleRateInALineAbove) {
  for (const std::string line : {"Fs=100 Hz", "Sampling rate: 100", "# sample_rate = 0.1 kHz",
                                 "Abtastrate;100;Hz", "dt = 0.01 s", "Sample interval (ms): 10",
                                 "Delta_X\t0.01", "Sampling frequency (Hz): 1.0E+02"})
    expect_read(line + "\na [g];b [g]\n" + rows(2, {.separator = ";"}), {{"a", "g"}, {"b", "g"}});
}

// Regression: the text after a number was ignored, so that "51 200 Hz" was 51 Hz.
TEST(TextLoggers, NumbersThatAreNotASampleRate) {
  const auto said = [](const std::string& line) {
    return sampling_from_header(parsed(line + "\na [g];b [g]\n" + rows(2, {.separator = ";"})));
  };
  for (const std::string line : {"# Sampling rate: 51 200 Hz", "# Sampling rate: 51'200 Hz",
                                 "# Sampling rate: 51\u00A0200 Hz", "# Sampling rate 12/03/2024",
                                 "# Sensor range FS = 50 g", "# Sampling rate: 1 of 3 blocks"})
    EXPECT_FALSE(said(line)) << line;
  for (const std::string line : {"# Sampling interval: 1/256 s", "# dt 1/256",
                                 "# Sample rate: 256 (24 bit)", "# fs = 256, 16 bit"}) {
    const std::optional<Sampling> found = said(line);
    ASSERT_TRUE(found) << line;
    EXPECT_DOUBLE_EQ(found->rate_hz, 256.0) << line;
  }
}

TEST(TextLoggers, MiniSeedTimePairs) {
  const Record r = parsed(
      "TIMESERIES XX_STA__HHZ_D, 12 samples, 100 sps, "
      "2021-03-01T10:00:00.000000, TSPAIR, INTEGER, Counts\n" +
      rows(1, {.separator = "  "}, stamps("2021-03-01T10:00:")));
  expect_channels(r, {{"2", ""}});
  EXPECT_NEAR(sampling_of(r, r.find_time()).rate_hz, 100.0, 1e-6);
}

TEST(TextLoggers, SeriesInRowsAreNotChannels) {
  EXPECT_THAT(refusal("TIMESERIES XX_STA__HHZ_D, 12 samples, 100 sps, "
                      "2021-03-01T10:00:00.000000, SLIST, INTEGER, Counts\n1 2 3 4 5 6\n"
                      "7 8 9 10 11 12\n"),
              HasSubstr("one sample per line (TSPAIR)"));
  EXPECT_THAT(refusal("Origin Time       2021/03/01 10:00:00\nSampling Freq(Hz) 100Hz\n"
                      "Scale Factor      2000(gal)/8388608\nMemo.\n 1 2 3 4 5 6 7 8\n"
                      " 1 2 3 4 5 6 7 8\n"),
              HasSubstr("times its scale factor"));
}

// ---- countries -------------------------------------------------------------------------------

TEST(TextLoggers, ExcelInGerman) {
  expect_read(
      "\xEF\xBB\xBF"
      "sep=;\r\nZeit [s];Kraft [kN]\r\n" +
          rows(1, {.separator = ";", .decimal = ',', .end = "\r\n"}, seconds(',')),
      {{"Kraft", "kN"}});
  expect_read("Datum;Kraft in kN\n" + rows(1, kGerman, stamps("01.03.2021 10:00:", "", ',')),
              {{"Kraft in kN", "kN"}});
}

TEST(TextLoggers, ExcelInAmerican) {
  expect_read("Time,a [g]\n" + rows(1, {}, stamps("3/25/2021 10:00:", " AM")), {{"a", "g"}});
  const std::string unclear = "Time,a [g]\n" + rows(1, {}, stamps("3/1/2021 10:00:", " PM"));
  EXPECT_THAT(refusal(unclear), HasSubstr("\"time_format\": \"month-first\""));
  expect_read(unclear, {{"a", "g"}}, {.time_format = "month-first"});
}

TEST(TextLoggers, ExcelUnicodeText) {
  const std::string text =
      "time [s]\ta [m/s2]\r\n" + rows(1, {.separator = "\t", .end = "\r\n"}, seconds());
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  expect_read(wide, {{"a", "m/s2"}});
}

TEST(TextLoggers, ThousandsSeparators) {
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"F [N];G [N]\n0,5;1.234,5\n1,5;12.345,25\n", "German"},
      {"F [N];G [N]\n0.5;1'234.5\n1.5;12'345.25\n", "Swiss"},
      {"F [N];G [N]\n0,5;1\xC2\xA0"
       "234,5\n1,5;12\xC2\xA0"
       "345,25\n",
       "French"},
      {"F [N];G [N]\n0,5;1\xA0"
       "234,5\n1,5;12\xA0"
       "345,25\n",
       "French, Latin-1"},
      {"F [N],G [N]\n0.5,\"1,234.5\"\n1.5,\"12,345.25\"\n", "American"}};
  for (const auto& [text, whose] : texts) {
    const Record r = parsed(text);
    ASSERT_EQ(r.columns.size(), 2U) << whose;
    EXPECT_EQ(r.columns[0].values, (std::vector<double>{0.5, 1.5})) << whose;
    EXPECT_EQ(r.columns[1].values, (std::vector<double>{1234.5, 12345.25})) << whose;
  }
}

TEST(TextLoggers, DecimalCommasInQuotes) {
  expect_read(
      "\"time [s]\",\"a [g]\"\n" + rows(1, {.decimal = ',', .before = "\"", .after = "\""},
                                        [](int n) { return "\"" + seconds(',')(n) + "\""; }),
      {{"a", "g"}});
  EXPECT_THAT(refusal("n,F\n1,\"1,234\"\n2,\"2,345\"\n"), HasSubstr("\"decimal\": \".\""));
  EXPECT_EQ(parsed("n,F\n1,\"1,234\"\n2,\"2,345\"\n", {.decimal = '.'}).columns[1].values,
            (std::vector<double>{1234.0, 2345.0}));
}

TEST(TextLoggers, OneColumnOfDecimalCommas) {
  const Record r = parsed("0,1108\n0,1845\n-0,2487\n-0,8802\n0,0410\n");
  ASSERT_EQ(r.columns.size(), 1U);
  EXPECT_EQ(r.columns[0].values, (std::vector<double>{0.1108, 0.1845, -0.2487, -0.8802, 0.0410}));
  EXPECT_EQ(r.layout->columns, 1);
  EXPECT_THAT(refusal("1,25\n3,50\n2,75\n4,15\n1,20\n9,99\n"), HasSubstr("\"decimal\": \",\""));
  EXPECT_THAT(refusal("a,b\n0,1 2\n0,3 4\n0,2 5\n"), HasSubstr("\"decimal\": \",\""));
}

TEST(TextLoggers, TabsWithDecimalCommasAndNoNames) {
  expect_read(rows(2, {.separator = "\t", .decimal = ','}, seconds(',', "%.4f")),
              {{"2", ""}, {"3", ""}});
}

TEST(TextLoggers, TimeStampFormats) {
  for (const auto& time :
       {stamps("2021-03-01T10:00:", "Z"), stamps("2021-03-01T10:00:", "+01:00"),
        stamps("2021/03/01 10:00:"), stamps("01.03.21 10:00:", "", ','), stamps("20210301T1000"),
        stamps("20210301 10:00:"), stamps("10:00:"), stamps("2021-03-01 10:00:", " CET"),
        stamps("2021-060T10:00:"), stamps("202103011000"), stamps("2021-03-01 10.00."),
        stamps("Mon Mar 01 10:00:", " 2021"), stamps("25/03/2021 10:00:"),
        stamps("2021-03-01\xC2\xA0"
               "10:00:")})
    expect_read("Stamp;a [g]\n" + rows(1, {.separator = ";"}, time), {{"a", "g"}});
}

TEST(TextLoggers, UnitsOfTimeInNames) {
  for (const auto& [name, step] : std::vector<std::pair<std::string, int>>{{"Time_ms", 10},
                                                                           {"timems", 10},
                                                                           {"Time [ms]", 10},
                                                                           {"TimeMS", 10},
                                                                           {"timestamp_ms", 10},
                                                                           {"micros", 10000},
                                                                           {"t_us", 10000},
                                                                           {"Time (µs)", 10000}})
    expect_read(name + ",a [g]\n" + rows(1, {}, [&](int n) { return std::to_string(step * n); }),
                {{"a", "g"}});
}

TEST(TextLoggers, SpreadsheetDates) {
  expect_read(
      "Date,a [g]\n" +
          rows(1, {}, [](int n) { return number(44256.25 + 0.01 * n / 86400.0, '.', "%.10f"); }),
      {{"a", "g"}});
}

TEST(TextLoggers, UnitsOfChannelsInNames) {
  for (const auto& [name, unit] :
       std::vector<std::pair<std::string, std::string>>{{"a (g)", "g"},
                                                        {"a [g]", "g"},
                                                        {"a / g", "g"},
                                                        {"a in mg", "mg"},
                                                        {"a - g", "g"},
                                                        {"a: g", "g"},
                                                        {"a <g>", "g"},
                                                        {"a m/s^2", "m/s^2"},
                                                        {"a [m·s⁻²]", "m·s⁻²"},
                                                        {"a [ms-2]", "ms-2"}}) {
    const Record r = parsed("time [s];" + name + "\n0;1\n0.01;2\n");
    EXPECT_EQ(unit_of(r.columns[1]), unit) << name;
  }
  // "acc_N" may mean north.
  EXPECT_EQ(unit_of({.name = "acc_N"}), "");
  EXPECT_EQ(possible_unit_of({.name = "acc_N"}), "N");
  EXPECT_EQ(possible_unit_of({.name = "acc_m_s2"}), "m/s^2");
}

// ---- sampling --------------------------------------------------------------------------------

TEST(TextLoggers, UnevenTimesReportTheRemedy) {
  const auto with = [](const std::function<int(int)>& count) {
    std::string text = "t [s],a\n";
    for (int n = 0; n < 200; ++n) text += number(0.01 * count(n), '.', "%.2f") + ",1\n";
    return text;
  };
  EXPECT_THAT(refusal(with([](int n) { return n < 100 ? n : n - 1; })),
              HasSubstr("delete the repeated row"));
  EXPECT_THAT(refusal(with([](int n) { return n % 120; })), HasSubstr("a new measurement begins"));
  EXPECT_THAT(refusal(with([](int n) { return n < 100 ? n : n + 1; })),
              HasSubstr("\"resample\": true"));
  std::string coarse = "Time,a\n";
  for (int n = 0; n < 300; ++n) coarse += "10:00:0" + std::to_string(n / 100) + ",1\n";
  EXPECT_THAT(refusal(coarse), HasSubstr("\"sample_rate\""));
  const Record r = parsed(coarse);
  EXPECT_EQ(sampling_of(r, 0, 100.0).rate_hz, 100.0);
  EXPECT_THROW((void)sampling_of(r, 0, 50.0), io::FileError);
}

TEST(TextLoggers, JitterBelowAPercentIsTakenAsEven) {
  std::string text = "t [s],a\n";
  for (int n = 0; n < 100; ++n) text += number(0.01 * n + (n % 3 - 1) * 1e-5, '.', "%.7f") + ",1\n";
  const Record r = parsed(text);
  const Sampling s = sampling_of(r, 0, 100.0);
  EXPECT_NEAR(s.rate_hz, 100.0, 1e-1);
  EXPECT_GT(s.jitter, 1e-3);
}

TEST(TextLoggers, WholeNumbersWithoutAUnitMayBeMilliseconds) {
  const Record r = parsed("timestamp,a\n0,1\n10,2\n20,1\n30,4\n");
  EXPECT_TRUE(sampling_of(r, 0).doubtful_unit);
}

// ---- LabVIEW ---------------------------------------------------------------------------------

TEST(TextLoggers, LabviewUnitsWithoutUnitOfTheLastChannel) {
  const std::string text =
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\n"
      "X_Columns\tMulti\n***End_of_Header***\t\n\t\n"
      "Channels\t3\nSamples\t2\t\t2\t\t2\nY_Unit_Label\tN\t\tg\nX0\t0\t\t0\t\t0\n"
      "Delta_X\t0.01\t\t0.01\t\t0.01\n***End_of_Header***\n"
      "X_Value\thammer\tX_Value\tacc\tX_Value\ttrigger\tComment\n"
      "0.00\t1\t0.00\t2\t0.00\t3\n0.01\t4\t0.01\t5\t0.01\t6\n";
  const io::Columns c = io::parse_labview(text, "hammer.lvm", {});
  ASSERT_EQ(c.columns.size(), 4U);
  EXPECT_EQ(c.columns[1].unit, "N");
  EXPECT_EQ(c.columns[2].unit, "g");
  EXPECT_EQ(c.columns[3].unit, "");
}

}  // namespace
}  // namespace wheeltap::signals
