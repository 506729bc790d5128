#include "io/netcdf/netcdf_reader.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "io/netcdf/netcdf_writer.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;

class NetcdfReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    NetcdfWriter out(path);
    out.about("1.2.3", "0123");
    const int group = out.group("posterior");
    const int chain = out.dimension(group, "chain", 2, 0),
              draw = out.dimension(group, "draw", 3, 0);
    const int slot = out.dimension(group, "slot", 2, 1);
    const int id = out.put(group, "location", {chain, draw, slot}, std::vector<double>(12, 0.25));
    out.text(group, id, "units", "m");
    out.put(group, "model", {chain, draw}, std::vector<int>{0, 1, 2, 3, 4, 5});
    test::put_bytes(path, out.close());
  }
  Kind error(const std::function<void()>& action) const {
    try {
      action();
    } catch (const FileError& e) {
      EXPECT_EQ(e.path(), path);
      text_ = e.reason();
      return e.kind();
    }
    return Kind::version;  // never thrown here
  }
  void expect_content(const NetcdfReader& in) const {
    const int group = in.required_group("posterior");
    EXPECT_FALSE(in.group("prior"));
    const NetcdfArray location = in.read(group, "location");
    EXPECT_EQ(location.shape, (std::vector<std::size_t>{2, 3, 2}));
    EXPECT_EQ(location.inner(), 2U);
    EXPECT_EQ(location.values, std::vector<double>(12, 0.25));
    const NetcdfArray model = in.read(group, "model");
    EXPECT_EQ(model.inner(), 1U);
    EXPECT_EQ(model.values, (std::vector<double>{0, 1, 2, 3, 4, 5})) << "integers as numbers";
    EXPECT_EQ(in.variables(group),
              (std::vector<std::string>{"chain", "draw", "slot", "location", "model"}));
    EXPECT_TRUE(in.has(group, "model"));
    EXPECT_FALSE(in.has(group, "weight"));
    EXPECT_EQ(in.text("inference_library"), "wheeltap");
    EXPECT_EQ(in.text("inference_library_version"), "1.2.3");
    EXPECT_EQ(in.text("no such"), "");
    EXPECT_EQ(in.text(group, "location", "units"), "m");
    EXPECT_EQ(in.text(group, "location", "no such"), "");
    EXPECT_EQ(in.text(group, "no such", "units"), "");
  }
  test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "posterior.nc";
  mutable std::string text_;
};

TEST_F(NetcdfReaderTest, RoundTripsWrittenData) {
  expect_content(NetcdfReader(path));
  expect_content(NetcdfReader(test::bytes_of(path), path));
}

// A file written in memory equals one on the disk: it can be extended and tracks the creation
// order. Rows are longer than a chunk, with several columns.
TEST_F(NetcdfReaderTest, RowwiseWritingEqualsWholeArrays) {
  constexpr std::size_t kRows = 3, kVariableLength = (1 << 16) + 5, kColumns = 2;
  const auto number = [](std::size_t r, std::size_t i, std::size_t c) {
    return static_cast<float>(1000.0 * static_cast<double>(r) + static_cast<double>(i % 997) +
                              0.5 * static_cast<double>(c));
  };
  NetcdfWriter out(path);
  const int group = out.group("g");
  const int row = out.dimension(group, "row", kRows, 0),
            at = out.dimension(group, "at", kVariableLength, 0),
            column = out.dimension(group, "column", kColumns, 0);
  out.put_rows<float>(group, "cube", {row, at, column},
                      [&](std::size_t r, std::vector<float>& values) {
                        EXPECT_TRUE(values.empty());
                        for (std::size_t i = 0; i < kVariableLength; ++i)
                          for (std::size_t c = 0; c < kColumns; ++c)
                            values.push_back(number(r, i, c));
                      });
  out.put_rows<int>(
      group, "flat", {row, at},
      [&](std::size_t r, std::vector<int>& values) {
        values.assign(kVariableLength, static_cast<int>(r));
      },
      NC_SHORT);
  test::put_bytes(path, out.close());
  const NetcdfReader in(path);
  const int read = in.required_group("g");
  const NetcdfArray cube = in.read(read, "cube"), flat = in.read(read, "flat");
  EXPECT_EQ(in.shape(read, "cube"), (std::vector<std::size_t>{kRows, kVariableLength, kColumns}));
  EXPECT_EQ(in.type(read, "cube"), NC_FLOAT);
  EXPECT_EQ(in.type(read, "flat"), NC_SHORT);
  const std::vector<double> second = in.read_last(read, "cube", 1);
  std::size_t wrong = 0;
  for (std::size_t r = 0; r < kRows; ++r) {
    for (std::size_t i = 0; i < kVariableLength; ++i) {
      const std::size_t n = r * kVariableLength + i;
      for (std::size_t c = 0; c < kColumns; ++c)
        wrong += cube.values[n * kColumns + c] != static_cast<double>(number(r, i, c));
      wrong += second[n] != static_cast<double>(number(r, i, 1));
      wrong += flat.values[n] != static_cast<double>(r);
    }
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(error([&] { static_cast<void>(in.read_last(read, "cube", kColumns)); }), Kind::foreign);
}

TEST_F(NetcdfReaderTest, ReadsEveryNthIndexOfTheSecondDimension) {
  NetcdfWriter out(path);
  const int group = out.group("posterior");
  const int chain = out.dimension(group, "chain", 2, 0), draw = out.dimension(group, "draw", 5, 0);
  const int slot = out.dimension(group, "slot", 2, 1);
  std::vector<double> numbers(20);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  out.put(group, "x", {chain, draw, slot}, numbers);
  test::put_bytes(path, out.close());
  const NetcdfReader in(path);
  const NetcdfArray every = in.read_every(in.required_group("posterior"), "x", 2);
  EXPECT_EQ(every.shape, (std::vector<std::size_t>{2, 3, 2}));
  EXPECT_EQ(every.values, (std::vector<double>{0, 1, 4, 5, 8, 9, 10, 11, 14, 15, 18, 19}));
  EXPECT_EQ(in.read_every(in.required_group("posterior"), "x", 1).values, numbers);
}

TEST_F(NetcdfReaderTest, FilesCanBeExtended) {
  int file = 0;
  ASSERT_EQ(nc_open(path.c_str(), NC_WRITE, &file), NC_NOERR);
  EXPECT_EQ(nc_put_att_text(file, NC_GLOBAL, "more", 3, "yes"), NC_NOERR);
  EXPECT_EQ(nc_close(file), NC_NOERR);
  EXPECT_EQ(NetcdfReader(path).text("more"), "yes");
  expect_content(NetcdfReader(path));
}

TEST_F(NetcdfReaderTest, ReportsMissingAndForeignContent) {
  const NetcdfReader in(path, "a posterior of wheeltap");
  EXPECT_EQ(error([&] { (void)in.required_group("prior"); }), Kind::foreign);
  EXPECT_EQ(text_, "has no group \"prior\": not a posterior of wheeltap");
  EXPECT_EQ(error([&] { (void)in.read(in.required_group("posterior"), "weight"); }), Kind::foreign);
  EXPECT_EQ(text_, "has no variable \"weight\": not a posterior of wheeltap");
}

TEST_F(NetcdfReaderTest, DamagedFilesAreCorrupt) {
  const std::string whole = test::bytes_of(path);
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 20) {
    test::put_bytes(path, whole.substr(0, size));
    EXPECT_EQ(error([&] { (void)NetcdfReader(path); }), Kind::corrupt) << size;
    EXPECT_EQ(error([&] { (void)NetcdfReader(whole.substr(0, size), path); }), Kind::corrupt);
  }
  test::put_bytes(path, "chain,draw\n0,1\n");
  EXPECT_EQ(error([&] { (void)NetcdfReader(path); }), Kind::corrupt);
  std::filesystem::remove(path);
  EXPECT_EQ(error([&] { (void)NetcdfReader(path); }), Kind::missing);
}

}  // namespace
}  // namespace wheeltap::io
