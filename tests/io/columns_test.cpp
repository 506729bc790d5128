#include "io/tables/columns.hpp"

#include <gtest/gtest.h>

namespace wheeltap::io {
namespace {

TEST(Columns, HeadersHaveANameAndAUnit) {
  const auto expect = [](const char* header, const char* name, const char* unit) {
    const Column c = column_of_header(header);
    EXPECT_EQ(c.header, header);
    EXPECT_EQ(c.name, name) << header;
    EXPECT_EQ(c.unit, unit) << header;
  };
  expect("force [N]", "force", "N");
  expect("force (N)", "force", "N");
  expect("time(ms)", "time", "ms");
  expect("time[ms]", "time", "ms");
  expect("f1 [ 1000 km/s ]", "f1", "1000 km/s");
  expect("location[1]", "location[1]", "");
  expect("location[1] [m]", "location[1]", "m");
  expect("X1(:,2)", "X1(:,2)", "");
  expect("force", "force", "");
  expect("[N]", "[N]", "");
  expect("", "", "");
  expect("]", "]", "");
  expect("a ]b[", "a ]b[", "");
}

TEST(Columns, FindsByHeaderNameOrNumber) {
  Columns table{.file = "r.csv",
                .columns = {column_of_header("force [N]"), column_of_header("x [m]"),
                            column_of_header("x [mm]")}};
  EXPECT_EQ(table.find("force"), 0);
  EXPECT_EQ(table.find("x [mm]"), 2);
  EXPECT_EQ(table.find("2"), 1);
  for (const auto& [name, part] :
       {std::pair{"x", "r.csv: 2 columns are called 'x'; use the column's number"},
        std::pair{"4", "r.csv: no column '4'; the columns are 'force [N]', 'x [m]', 'x [mm]'"},
        std::pair{"0", "no column '0'"}}) {
    try {
      (void)table.find(name);
      ADD_FAILURE() << name;
    } catch (const FileError& error) {
      EXPECT_EQ(error.kind(), FileError::Kind::corrupt);
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

TEST(Columns, PlacesCountLinesThatAreNotRows) {
  Columns table{.columns = {column_of_header("x [m]")}, .first_line = 3, .skipped = {2, 2, 5}};
  EXPECT_EQ(table.place(0).line, 3);
  EXPECT_EQ(table.place(1).line, 4);
  EXPECT_EQ(table.place(2).line, 7);
  EXPECT_EQ(table.place(5).line, 11);
  EXPECT_EQ(table.place(2, 0).text(), ", line 7, column 1 ('x [m]')");
  table.first_line = 0;
  EXPECT_EQ(table.place(2, 0).text(), ", sample 2, column 1 ('x [m]')");
}

}  // namespace
}  // namespace wheeltap::io
