#include "io/formats/formats.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>

#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;

/// A minimal format: "TOY", then doubles, one column.
Columns parse_toy(std::string bytes, const std::filesystem::path& name, const Wanted&) {
  if ((bytes.size() - 3) % sizeof(double) != 0)
    throw FileError(Kind::corrupt, name, "ends within a number");
  Columns table{.file = name.string(), .columns = {column_of_header("toy [m]")}};
  table.columns[0].values.resize((bytes.size() - 3) / sizeof(double));
  std::memcpy(table.columns[0].values.data(), bytes.data() + 3, bytes.size() - 3);
  return table;
}

class Formats : public testing::Test {
 protected:
  std::string error(const std::string& file, Kind kind) const {
    try {
      (void)read_columns(directory / file, {}, known);
    } catch (const FileError& e) {
      EXPECT_EQ(e.kind(), kind) << e.what();
      return e.reason();
    }
    return "nothing thrown";
  }
  test::TemporaryDirectory directory;
  std::vector<Format> known = {formats().begin(), formats().end()};
};

TEST_F(Formats, AFormatIsOneEntryInTheList) {
  const double values[] = {1.5, -2.0};
  std::string bytes = "TOY";
  bytes.append(reinterpret_cast<const char*>(values), sizeof values);
  test::put_bytes(directory / "a.toy", bytes);
  EXPECT_NE(error("a.toy", Kind::foreign).find("'.toy'"), std::string::npos);

  known.push_back({.name = "toy", .endings = {".toy"}, .magic = {"TOY"}, .parse = parse_toy});
  EXPECT_EQ(read_columns(directory / "a.toy", {}, known).columns[0].values,
            (std::vector<double>{1.5, -2.0}));
  test::put_bytes(directory / "A.TOY", bytes);
  EXPECT_EQ(read_columns(directory / "A.TOY", {}, known).rows(), 2) << "by its ending in capitals";
  test::put_bytes(directory / "renamed.csv", bytes);
  EXPECT_EQ(read_columns(directory / "renamed.csv", {}, known).rows(), 2) << "by how it begins";
  test::put_bytes(directory / "cut.toy", bytes.substr(0, 10));
  EXPECT_EQ(error("cut.toy", Kind::corrupt), "ends within a number");
}

TEST_F(Formats, RejectsUnknownFormatsWithTheListOfKnownOnes) {
  test::put_bytes(directory / "r.doc", "PK");
  const std::string why = error("r.doc", Kind::foreign);
  EXPECT_TRUE(why.starts_with(
      "unknown file extension '.doc'; the known formats are delimited text (.csv, .tsv, "))
      << why;
  for (const char* part : {"; MATLAB (.mat); universal file (.uff, .unv, .uf); ",
                           "NumPy array (.npy)", "PEER record (.at2, ", "TDMS (.tdms)"})
    EXPECT_NE(why.find(part), std::string::npos) << part;
}

TEST_F(Formats, RecognisesTextExtensions) {
  for (const char* name : {"r.csv", "r.TXT", "r.dat", "r"}) {
    test::put_bytes(directory / name, "x\n1\n");
    EXPECT_EQ(read_columns(directory / name).rows(), 1) << name;
  }
}

TEST_F(Formats, RejectsMissingFilesAndFolders) {
  EXPECT_EQ(error("none.csv", Kind::missing), "no such file");
  EXPECT_EQ(error("none.mat", Kind::missing), "no such file");
  EXPECT_EQ(error("", Kind::missing), "cannot be read: is a directory");
}

TEST_F(Formats, RejectsPipes) {
  ASSERT_EQ(::mkfifo((directory / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(error("pipe", Kind::missing).starts_with("cannot be read: is a pipe"));
}

}  // namespace
}  // namespace wheeltap::io
