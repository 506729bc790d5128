#include "io/tables/delimited_text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "base/random.hpp"

namespace wheeltap::io {
namespace {

Columns parse(const std::string& text, const Wanted& wanted = {}) {
  return parse_delimited_text(text, "t.csv", wanted);
}

std::string error(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const FileError& e) {
    EXPECT_EQ(e.kind(), FileError::Kind::corrupt);
    return e.what();
  }
  return "nothing thrown";
}

using Values = std::vector<double>;

TEST(DelimitedText, Latin1BecomesUtf8) {
  const Columns t = parse(
      "Weg [\xb5m];\"\xc4quator; au\xdf"
      "en [\xb0]\"\n0;1\n");
  ASSERT_EQ(t.columns.size(), 2U);
  EXPECT_EQ(t.columns[0].name, "Weg");
  EXPECT_EQ(t.columns[0].unit, "µm");
  EXPECT_EQ(t.find("Äquator; außen [°]"), 1);
  EXPECT_EQ(parse("Weg [µm]\n0\n").find("Weg [µm]"), 0);
}

TEST(DelimitedText, ReadsAllSeparators) {
  for (const std::string s : {",", ";", "\t", " , ", "; "}) {
    const Columns t =
        parse("time [s]" + s + "\"tip" + s + "left (mm)\"\n0" + s + "+1.5\n1" + s + "\"-2e-3\"\n");
    ASSERT_EQ(t.columns.size(), 2U) << s;
    EXPECT_EQ(t.columns[1].unit, "mm");
    EXPECT_EQ(t.columns[0].values, (Values{0, 1})) << s;
    EXPECT_EQ(t.columns[1].values, (Values{1.5, -2e-3})) << s;
  }
}

TEST(DelimitedText, BlanksSeparateNumbersOnly) {
  Columns t = parse("  0.0   1\t2\n 0.5 -1   nan \n");
  ASSERT_EQ(t.columns.size(), 3U);
  EXPECT_EQ(t.columns[1].values, (Values{1, -1}));
  EXPECT_TRUE(std::isnan(t.columns[2].values[1]));
  t = parse("time [s] wave speed\n0 1 2\n1 2 3\n");
  ASSERT_EQ(t.columns.size(), 3U);
  EXPECT_EQ(t.columns[0].unit, "s");
  EXPECT_EQ(t.columns[2].header, "speed");
  t = parse("t [ms] \"tip left\" [1000 km/s]\n0 1\n");
  ASSERT_EQ(t.columns.size(), 2U);
  EXPECT_EQ(t.columns[1].name, "tip left");
  EXPECT_EQ(t.columns[1].unit, "1000 km/s");
  t = parse("wave speed [1000 km/s]\n9.1\n9.2\n");
  ASSERT_EQ(t.columns.size(), 1U);
  EXPECT_EQ(t.columns[0].name, "wave speed");
}

TEST(DelimitedText, CommentsBlankLinesAndLineEnds) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const Columns t = parse("\xEF\xBB\xBF# by a logger" + end + end + "x,y" + end + "1,2" + end +
                            "  # paused" + end + "3,4" + end + end + " " + end);
    ASSERT_EQ(t.rows(), 2) << int{end[0]};
    EXPECT_EQ(t.columns[1].values, (Values{2, 4}));
    EXPECT_EQ(t.place(0).line, 4);
    EXPECT_EQ(t.place(1).line, 6);
  }
  EXPECT_EQ(parse("1.,2\n3,4").rows(), 2) << "no newline at the end";
  EXPECT_EQ(parse("1.,2\n3,4").first_line, 1);
}

TEST(DelimitedText, ErrorsNameFileLineColumnAndValue) {
  EXPECT_EQ(error("a [N];b\n0;1.5\n0;1.5\n0;1,5\n"),
            "t.csv, line 4, column 2 ('b'): '1,5' is not a number (decimal commas are read with "
            "\"decimal\": \",\")");
  EXPECT_EQ(
      error("# c\na,b\n0,1\n#\n0,x y\n"),
      "t.csv, line 5, column 2 ('b'): 'x y' is not a number: leave the cell empty if it stands "
      "for a missing value, or do not read this column (\"role\": \"ignore\")");
  EXPECT_EQ(
      error("a,b\n0,1\n0\n"),
      "t.csv, line 3: 1 columns, must be 2 as in line 1: the last row is truncated; delete it");
  EXPECT_EQ(error("a,b\n0,1\n0\n0,1\n"), "t.csv, line 3: 1 columns, must be 2 as in line 1");
  EXPECT_EQ(error("a,b\n0,1,2\n"),
            "t.csv, line 2: 3 columns, must be 2 as in line 1 (if the numbers have decimal commas, "
            "export the table with semicolons between the columns; if that line holds no names, "
            "state \"header\": 0)");
  EXPECT_EQ(error("a;b\n0;1;2\n"),
            "t.csv, line 2: 3 columns, must be 2 as in line 1 (if that line holds no names, state "
            "\"header\": 0, or the line of the names)");
  EXPECT_EQ(error("t;b\n2026-01-01T00:00Z;1\n2026-01-01T01:00;1\n2026-01-01T02:00;1\n"),
            "t.csv, line 3, column 1 ('t'): '2026-01-01T01:00': state the offset from UTC in all "
            "rows or in no row");
  EXPECT_EQ(error("Time;b\nMonday 0;1\n"),
            "t.csv, line 2, column 1 ('Time'): 'Monday 0' is not a number or a known time stamp: "
            "state the form of the times, for example \"time_format\": \"%d.%m.%Y %H:%M:%S\"");
  EXPECT_EQ(error("0 1\n0 1 2\n0 1\n"), "t.csv, line 2: 3 columns, must be 2 as in line 1");
  EXPECT_EQ(error("a,b\n0,1\n\n0,1\n"),
            "t.csv, line 3: empty line: delete it, or cut the file there if another table follows");
  EXPECT_EQ(error("a,b\n0,\"1\n"),
            "t.csv, line 2, column 2 ('b'): '\"1' has a quote that is not closed on its line");
  EXPECT_EQ(error("a,b\n0,\"1\"2\n"),
            "t.csv, line 2, column 2 ('b'): '\"1\"2' has text after its closing quote");
  EXPECT_EQ(error("a,\"b\n0,1\n"),
            "t.csv, line 1, column 2: '\"b' has a quote that is not closed on its line");
  const std::string why =
      ": no line has numbers or times (without units) separated by commas, semicolons, "
      "tabs, bars or blanks. Export the table with one of these separators";
  EXPECT_EQ(error("a,b\n"), "t.csv: no data" + why);
  EXPECT_EQ(error(""), "t.csv: no data");
  EXPECT_EQ(error("# nothing\n\n"), "t.csv: no data" + why);
  EXPECT_EQ(error(std::string("a\n1\n\0\n", 6)), "t.csv, line 3: is not text: there is a NUL byte");
  for (const char* cell : {"1e999", "--1", "+-1", "1.2.3", "1e", "0x10", "12Hz"})
    EXPECT_TRUE(error(std::string("a,b\n0,") + cell + "\n")
                    .starts_with("t.csv, line 2, column 2 ('b'): '" + std::string(cell) +
                                 "' is not a number"))
        << cell;
}

TEST(DelimitedText, EmptyCellsAreNaN) {
  const Columns t = parse("a,b,c\n,nan,\n1,,inf\n\"\", ,-2\n");
  for (const auto& [column, row] : {std::pair{0, 0}, {1, 0}, {2, 0}, {1, 1}, {0, 2}, {1, 2}})
    EXPECT_TRUE(std::isnan(
        t.columns[static_cast<std::size_t>(column)].values[static_cast<std::size_t>(row)]));
  EXPECT_EQ(t.columns[2].values[1], HUGE_VAL);
  EXPECT_EQ(t.columns[2].values[2], -2.0);
}

TEST(DelimitedText, CountsPrintedDigits) {
  const Columns t = parse("0.50,1e-3,123\n0.25,2.5e2,4500\n0.1,1.25e-4,nan\n");
  EXPECT_EQ(t.columns[0].decimals, 2);
  EXPECT_EQ(t.columns[0].digits, 2);
  EXPECT_EQ(t.columns[1].decimals, 6);
  EXPECT_EQ(t.columns[1].digits, 3);
  EXPECT_EQ(t.columns[2].decimals, 0);
  EXPECT_EQ(t.columns[2].digits, 4);
}

// The fast path for plain numbers rounds like std::from_chars, to the last bit.
TEST(DelimitedText, NumbersAreTheNearestDoubles) {
  base::Random random(1, 0, 0, base::Purpose::test);
  std::string text;
  std::vector<double> expected;
  const auto add = [&](const std::string& cell) {
    double value = 0.0;
    ASSERT_EQ(std::from_chars(cell.data(), cell.data() + cell.size(), value).ec, std::errc());
    expected.push_back(value);
    text += cell + "\n";
  };
  for (const char* cell : {"0", "-0", "0.000", "9007199254740993", "9007199254740992e22",
                           "123456789012345678901234567890", "0.1e-22", "4.9e-324", "1e22", "1e23",
                           "1.7976931348623157e308", ".5", "5.", "1E+05", "00012.50", "0e999"})
    add(cell);
  for (int i = 0; i < 20'000; ++i) {
    char cell[64];
    const double x = std::bit_cast<double>(random.bits());
    const double near = std::ldexp(random.normal(), random.index(60) - 30);
    const int digits = 1 + random.index(20);
    std::snprintf(cell, sizeof cell,
                  i % 3 == 0   ? "%.*g"
                  : i % 3 == 1 ? "%.*e"
                               : "%.*f",
                  digits, i % 4 == 0 && i % 3 != 2 && std::isfinite(x) ? x : near);
    double ignored = 0.0;
    const std::string_view view(cell);
    if (std::from_chars(view.data(), view.data() + view.size(), ignored).ec == std::errc())
      add(cell);
  }
  const Columns t = parse(text);
  ASSERT_EQ(t.columns[0].values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint64_t>(t.columns[0].values[i]),
              std::bit_cast<std::uint64_t>(expected[i]))
        << i << ": " << expected[i];
}

// Only requested columns are read: the others may be text.
TEST(DelimitedText, ReadsOnlyRequestedColumns) {
  const std::string text = "t,who,x\n0,\"a, b\",1\n1,c,2\n";
  const Columns t =
      parse(text, [](const Columns& c, std::size_t i) { return c.columns[i].name != "who"; });
  EXPECT_EQ(t.rows(), 2);
  EXPECT_TRUE(t.columns[1].values.empty());
  EXPECT_EQ(t.columns[2].values, (Values{1, 2}));
  EXPECT_NE(error(text).find("line 2, column 2 ('who'): 'a, b' is not a number"),
            std::string::npos);
}

TEST(DelimitedText, CellsReturnTheirText) {
  const DelimitedText text("name, \"say \"\"hi\"\"\" \n a b ,\"\"\n\n# c\n1\n", "t.csv",
                           FirstRow::header);
  ASSERT_EQ(text.rows(), 2);
  EXPECT_EQ(text.headers()[1].name, "say \"hi\"");
  EXPECT_EQ(text.cells(0), (std::vector<std::string>{"a b", ""}));
  EXPECT_EQ(text.cells(1), std::vector<std::string>{"1"}) << "rows may be short";
  EXPECT_EQ(text.line(1), 5);
  EXPECT_EQ(DelimitedText("1,2\n", "t.csv", FirstRow::header).header_line(), 1);
}

// Any bytes give a table or a FileError.
TEST(DelimitedText, DamagedTextGivesATableOrAnError) {
  const std::string whole =
      "\xEF\xBB\xBF# made\r\ntime [s],\"force, left [N]\",x (mm)\r\n0.0,1e-3,nan\r\n"
      "0.1,\"2\",\r\n0.2,+3.5,-4\r\n# end\r\n";
  constexpr std::array kBytes = {'\0', '\n', '\r', ',', ';', '\t', ' ', '"',    '#',
                                 '[',  ']',  '(',  'e', '-', '.',  '7', '\xFF', '\xEF'};
  base::Random random(2, 0, 0, base::Purpose::test);
  int tables = 0, errors = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text = whole;
    for (int edits = 1 + random.index(4); edits > 0; --edits) {
      const auto at = static_cast<std::size_t>(random.index(static_cast<int>(text.size())));
      const char byte = kBytes[static_cast<std::size_t>(random.index(kBytes.size()))];
      switch (random.index(4)) {
        case 0:
          text[at] = byte;
          break;
        case 1:
          text.insert(at, 1, byte);
          break;
        case 2:
          text.erase(at, 1);
          break;
        default:
          text.resize(at + 1);
      }
    }
    try {
      const Columns t = parse(text);
      ++tables;
      for (const Column& c : t.columns) ASSERT_EQ(static_cast<int>(c.values.size()), t.rows());
    } catch (const FileError&) {
      ++errors;
    }
  }
  EXPECT_GT(tables, 1000);
  EXPECT_GT(errors, 1000);
}

}  // namespace
}  // namespace wheeltap::io
