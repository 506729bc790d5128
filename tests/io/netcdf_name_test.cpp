#include "io/netcdf/netcdf_name.hpp"

#include <gtest/gtest.h>
#include <netcdf.h>

#include "io/netcdf/netcdf_writer.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

const std::vector<std::string> kNames = {"k",
                                         "k3",
                                         "µ",
                                         "0",
                                         "_",
                                         "a b",
                                         "a.b",
                                         "k[1]",
                                         " k",
                                         "..",
                                         ".",
                                         "-k",
                                         "k ",
                                         "a/b",
                                         "k'",
                                         "(k",
                                         "\"",
                                         "",
                                         "\x1b",
                                         "k\n",
                                         "\xff",
                                         "\x7f",
                                         "梁",
                                         std::string(200, 'k'),
                                         std::string(257, 'k'),
                                         "col " + std::string(300, 'x')};

// Checks with the library itself: it accepts all names that we accept.
TEST(NetcdfName, LibraryAcceptsValidNames) {
  const test::TemporaryDirectory directory;
  NetcdfWriter file(directory / "names.nc");
  int groups = 0;
  for (const std::string& name : kNames) {
    if (netcdf_name_error(name)) continue;
    ++groups;
    EXPECT_NO_THROW(file.put(file.group(("g" + std::to_string(groups)).c_str()), name, {},
                             std::vector<double>{1.0}))
        << name;
  }
}

TEST(NetcdfName, ReportsInvalidNames) {
  EXPECT_FALSE(netcdf_name_error("k3 (left)"));
  EXPECT_EQ(netcdf_name_error(" k"), "must begin with a letter, a digit or _");
  EXPECT_EQ(netcdf_name_error(".."), "must begin with a letter, a digit or _");
  EXPECT_EQ(netcdf_name_error(std::string(257, 'k')), "has 257 bytes, must have at most 200");
  EXPECT_EQ(netcdf_name_error("k\n"), "must be UTF-8 without control characters");
}

TEST(NetcdfName, ReplacementsAreValidNames) {
  for (const std::string& name : kNames) EXPECT_FALSE(netcdf_name_error(netcdf_name(name))) << name;
  EXPECT_EQ(netcdf_name("displacement"), "displacement");
  EXPECT_EQ(netcdf_name("a/b"), "a_b");
}

}  // namespace
}  // namespace wheeltap::io
