#include "io/drawings/outline_file.hpp"

#include <gtest/gtest.h>

#include "io/file_error.hpp"

namespace wheeltap::io {
namespace {

Drawing parsed_outline(const std::string& text) {
  return parse_outline_table(text, "a.csv");
}

void expect_outline_failure(const std::string& text, std::initializer_list<std::string> words) {
  try {
    (void)parsed_outline(text);
    ADD_FAILURE() << "not refused: " << *words.begin();
  } catch (const FileError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "\"" << word << "\" is not in: " << error.what();
  }
}

TEST(OutlineFile, EmptyLinesSeparateRings) {
  const Drawing d =
      parsed_outline("# corroded\ny [mm],z [mm]\n0,0\n2,0\n# a pit\n2,1\n\n\n5,5\n6,5\n6,6\n");
  ASSERT_EQ(d.outlines.size(), 2u);
  EXPECT_EQ(d.outlines[0].size(), 3u);
  EXPECT_EQ(d.outlines[1][0].x, 5.0);
  EXPECT_EQ(d.unit, 1e-3);
}

TEST(OutlineFile, PartsSeparateRings) {
  const Drawing d =
      parsed_outline("part;z;y\nouter;0;0\nouter;0;2\nouter;1;2\nhole;5;4\nhole;5;6\nhole;6;6\n");
  ASSERT_EQ(d.outlines.size(), 2u);
  EXPECT_EQ(d.outlines[1][0].x, 4.0);
  EXPECT_EQ(d.outlines[1][0].y, 5.0);
  EXPECT_EQ(d.unit, 0.0);
}

TEST(OutlineFile, ReadsTablesWithoutAHeader) {
  const Drawing d = parsed_outline("0 0\r\n1 0\r\n1 1\r\n\r\n2 2\r\n3 2\r\n3 3\r\n");
  ASSERT_EQ(d.outlines.size(), 2u);
  EXPECT_EQ(d.outlines[0].size(), 3u);
}

TEST(OutlineFile, RejectsInvalidTables) {
  expect_outline_failure("a,b\n0,0\n", {"line 1", "y and z"});
  expect_outline_failure("y,z\n0,0\n1,x\n", {"line 3", "column 2", "'x'"});
  expect_outline_failure("y,z\n0,0\n1\n", {"line 3", "1 cells"});
  expect_outline_failure("y [mm],z [cm]\n0,0\n", {"'mm'", "'cm'"});
  expect_outline_failure("y [ell],z [ell]\n0,0\n", {"'ell'", "mm"});
  expect_outline_failure("y,z\n", {"no corners"});
}

}  // namespace
}  // namespace wheeltap::io
