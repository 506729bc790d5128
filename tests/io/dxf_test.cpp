#include "io/drawings/dxf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "io/file_error.hpp"

namespace wheeltap::io {
namespace {

std::string drawing(const std::string& entities, const std::string& units = "") {
  std::string text = "0\nSECTION\n2\nHEADER\n";
  if (!units.empty()) text += "9\n$INSUNITS\n70\n" + units + "\n";
  return text + "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
}

Drawing parsed(const std::string& entities, const std::string& units = "") {
  return parse_dxf(drawing(entities, units), "a.dxf");
}

std::string line(double x1, double y1, double x2, double y2) {
  return "0\nLINE\n8\n0\n10\n" + std::to_string(x1) + "\n20\n" + std::to_string(y1) + "\n11\n" +
         std::to_string(x2) + "\n21\n" + std::to_string(y2) + "\n";
}

/// The area inside a path, including the segments of its arcs.
double area(const ClosedPath& path) {
  double twice = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathCorner &a = path[i], &b = path[(i + 1) % path.size()];
    twice += a.x * b.y - b.x * a.y;
    if (a.bulge == 0.0) continue;
    const double turn = 4.0 * std::atan(a.bulge);
    const double r = 0.5 * std::hypot(b.x - a.x, b.y - a.y) / std::sin(0.5 * turn);
    twice += r * r * (turn - std::sin(turn));
  }
  return 0.5 * twice;
}

void expect_failure(const std::string& bytes, std::initializer_list<std::string> words) {
  try {
    (void)parse_dxf(bytes, "a.dxf");
    ADD_FAILURE() << "not refused: " << *words.begin();
  } catch (const FileError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "\"" << word << "\" is not in: " << error.what();
  }
}

TEST(Dxf, LightPolylinesWithBulges) {
  // A stadium: 2 x 1 with half circles at its ends.
  const Drawing d = parsed(
      "0\nLWPOLYLINE\n90\n4\n70\n1\n10\n0\n20\n0\n10\n2\n20\n0\n42\n1\n10\n2\n20\n1\n"
      "10\n0\n20\n1\n42\n1\n",
      "4");
  ASSERT_EQ(d.outlines.size(), 1u);
  EXPECT_EQ(d.unit, 1e-3);
  EXPECT_NEAR(area(d.outlines[0]), 2.0 + M_PI / 4.0, 1e-12);
}

TEST(Dxf, OldPolylines) {
  const std::string corner = "0\nVERTEX\n8\n0\n10\n";
  const Drawing d = parsed("0\nPOLYLINE\n66\n1\n70\n1\n10\n0\n20\n0\n" + corner + "0\n20\n0\n" +
                           corner + "3\n20\n0\n" + corner + "3\n20\n2\n0\nSEQEND\n");
  ASSERT_EQ(d.outlines.size(), 1u);
  EXPECT_EQ(d.outlines[0].size(), 3u);
  EXPECT_NEAR(area(d.outlines[0]), 3.0, 1e-15);
  EXPECT_EQ(d.unit, 0.0);
}

// Regression: the vertices of a mirrored POLYLINE (extrusion -z) were not mirrored.
TEST(Dxf, MirroredPolylines) {
  const std::string corner = "0\nVERTEX\n8\n0\n10\n";
  const Drawing d = parsed("0\nPOLYLINE\n66\n1\n70\n1\n230\n-1\n10\n0\n20\n0\n" + corner +
                           "1\n20\n0\n" + corner + "3\n20\n0\n" + corner + "3\n20\n2\n0\nSEQEND\n");
  ASSERT_EQ(d.outlines.size(), 1u);
  for (const PathCorner& c : d.outlines[0]) EXPECT_LT(c.x, 0.0);
}

TEST(Dxf, LinesAndArcsInAnyOrderAndDirection) {
  // A quarter of a ring, radii 1 and 2; the outer arc runs 0° to 90°.
  const std::string arcs =
      "0\nARC\n10\n0\n20\n0\n40\n2\n50\n0\n51\n90\n0\nARC\n10\n0\n20\n0\n40\n1\n50\n0\n51\n90\n";
  for (const std::string& lines :
       {line(1, 0, 2, 0) + line(0, 2, 0, 1), line(2, 0, 1, 0) + line(0, 1, 0, 2)}) {
    for (const std::string& all : {lines + arcs, arcs + lines}) {
      const Drawing d = parsed(all + "0\nTEXT\n10\n5\n20\n5\n1\nhello\n");
      ASSERT_EQ(d.outlines.size(), 1u);
      EXPECT_NEAR(std::abs(area(d.outlines[0])), 0.75 * M_PI, 1e-9);
    }
  }
  // Across 0°, and more than half a turn: a disc of three quarters.
  const Drawing d = parsed("0\nARC\n10\n0\n20\n0\n40\n1\n50\n180\n51\n90\n" + line(0, 1, -1, 0));
  EXPECT_NEAR(std::abs(area(d.outlines[0])), 0.75 * M_PI + 0.5, 1e-6);
}

TEST(Dxf, JoinsManyLinesInAnyOrder) {
  // A comb: many ends share their x or their y.
  constexpr int kTeeth = 2000;
  std::vector<std::string> lines;
  const auto add = [&](double x1, double y1, double x2, double y2) {
    lines.push_back(lines.size() % 3 == 0 ? line(x2, y2, x1, y1) : line(x1, y1, x2, y2));
  };
  for (int i = 0; i < kTeeth; ++i) {
    const double x = 2.0 * i;
    add(x, 0, x, 1);
    add(x, 1, x + 1, 1);
    add(x + 1, 1, x + 1, 0);
    if (i + 1 < kTeeth) add(x + 1, 0, x + 2, 0);
  }
  const double width = 2.0 * kTeeth - 1.0;
  add(width, 0, width, -1);
  add(width, -1, 0, -1);
  add(0, -1, 0, 0);
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += lines[(i * 3571) % lines.size()];
  const Drawing d = parsed(text);
  ASSERT_EQ(d.outlines.size(), 1u);
  EXPECT_EQ(d.outlines[0].size(), lines.size());
  EXPECT_NEAR(std::abs(area(d.outlines[0])), kTeeth + width, 1e-6);
}

TEST(Dxf, CirclesAndSeveralOutlines) {
  const Drawing d = parsed(line(0, 0, 4, 0) + line(4, 0, 4, 4) + line(4, 4, 0, 4) +
                               line(0, 4, 0, 0) + "0\nCIRCLE\n10\n2\n20\n2\n40\n1\n",
                           "6");
  ASSERT_EQ(d.outlines.size(), 2u);
  EXPECT_NEAR(std::abs(area(d.outlines[0])) + std::abs(area(d.outlines[1])), 16 + M_PI, 1e-12);
  // Seen from behind: mirrored.
  const Drawing back = parsed("0\nCIRCLE\n10\n2\n20\n2\n40\n1\n230\n-1\n");
  EXPECT_EQ(back.outlines[0][0].x, -3.0);
}

TEST(Dxf, WindowsLineEnds) {
  std::string text = drawing("0\nCIRCLE\n10\n2\n20\n2\n40\n1\n", "5"), with_returns;
  for (const char c : text) with_returns += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parse_dxf(with_returns, "a.dxf").unit, 0.01);
}

TEST(Dxf, RejectsInvalidDrawings) {
  expect_failure("hello\nworld\n", {"a.dxf", "does not begin"});
  expect_failure("AutoCAD Binary DXF\r\n", {"binary"});
  expect_failure(drawing(""), {"no closed"});
  expect_failure(drawing(line(0, 0, 1, 0) + line(1, 0, 1, 1)), {"line 12", "do not close", "(1.0"});
  expect_failure(drawing("0\nSPLINE\n"), {"SPLINE", "explode"});
  expect_failure(drawing("0\nCIRCLE\n10\nx\n20\n0\n40\n1\n"), {"line 14", "'x'", "number"});
  expect_failure(drawing("0\nCIRCLE\n10\n1\n20\n0\n"), {"CIRCLE", "40", "missing"});
  expect_failure(drawing("0\nCIRCLE\n10\n1\n20\n0\n40\n-1\n"), {"radius", "positive"});
  expect_failure("0\nSECTION\nabc\n", {"line 3", "group code"});
  expect_failure("0\nSECTION\n2\n", {"ends within a pair"});
  // A missing hole would make the section larger.
  std::string cut = drawing("0\nCIRCLE\n10\n1\n20\n0\n40\n1\n0\nCIRCLE\n10\n1\n20\n0\n40\n0.5\n");
  cut.erase(cut.rfind("0\nCIRCLE"));
  expect_failure(cut, {"ENDSEC", "truncated"});
}

TEST(Dxf, Units) {
  EXPECT_EQ(metres("mm"), 1e-3);
  EXPECT_EQ(metres("in"), 0.0254);
  EXPECT_EQ(metres("parsec"), 0.0);
}

}  // namespace
}  // namespace wheeltap::io
