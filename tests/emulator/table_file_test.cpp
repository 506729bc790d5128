#include "emulator/table_file.hpp"

#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <optional>
#include <random>
#include <thread>

#include "tests/emulator/temporary_directory.hpp"

// NetCDF and HDF5 leak memory when they fail to open a corrupt file.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libnetcdf\nleak:libhdf5\n";
}

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

class TableFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path(const std::string& name = "table.nc") const {
    return directory / name;
  }
  [[nodiscard]] std::string bytes() const { return test::bytes_of(path()); }
  void put(const std::string& content) const { test::put_bytes(path(), content); }
  /// The kind of error when reading the file; nullopt on success.
  [[nodiscard]] std::optional<Kind> read_error(const std::string& fingerprint = {}) const {
    try {
      (void)read_table_file(path(), {.expected_fingerprint = fingerprint});
    } catch (const io::FileError& error) {
      EXPECT_EQ(error.path(), path());
      EXPECT_FALSE(error.reason().empty());
      EXPECT_NE(std::string(error.what()).find(path().string()), std::string::npos);
      return error.kind();
    }
    return std::nullopt;
  }

  test::TemporaryDirectory directory;
};

TableFile example() {
  TableFile file;
  file.attributes = {{"case", R"({"kind": "damage"})"},
                     {"fingerprint", io::fingerprint("beam")},
                     {"wheeltap_version", "0.1.0"},
                     {"command", "wheeltap table case.json -o table.nc"}};
  for (int count : {1, 2}) {
    Table t;
    for (int i = 1; i <= count; ++i) {
      const std::string label = std::string("[") + std::to_string(i) + "]";
      t.factors.push_back({"location" + label, "m", {0.05, 0.15, 0.25}});
      t.factors.push_back({"reduction" + label, "", {0.0, 0.2, 0.4, 0.6}, Scale::compliance});
    }
    t.response_name = "frequency";
    t.response_unit = "Hz";
    t.values = RowMatrix::Random(count == 1 ? 12 : 144, 20);
    for (int k = 0; k < 20; ++k) t.holdout.push_back({0.1 * k, 0.2 * k, 3.0, 1 - 0.01 * k});
    t.holdout[3].q2 = -HUGE_VAL;
    file.tables["count_" + std::to_string(count)] = t;
  }
  file.tables["count_1"].holdout.clear();
  return file;
}

// HDF5 crashes on some of them, in the reader's child process.
TEST_F(TableFileTest, NoDamageEndsTheProgram) {
  write_table_file(path(), example());
  const std::string whole = bytes();
  std::mt19937_64 random(6);
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int i = 0; i < 600; ++i) {
    std::string damaged = whole;
    for (std::size_t n = 1 + below(4); n > 0; --n) {
      const std::size_t at = below(std::min<std::size_t>(damaged.size() - 4, 12000));
      if (below(2) == 0)
        damaged[at] = static_cast<char>(below(256));
      else
        damaged.replace(at, 4, below(2) == 0 ? std::string(4, '\xff') : std::string(4, '\0'));
    }
    put(damaged);
    (void)read_error();
  }
}

TEST_F(TableFileTest, ReadsBackWhatItWrote) {
  const TableFile written = example();
  write_table_file(path(), written);
  const TableFile read = read_table_file(path(), {.expected_fingerprint = io::fingerprint("beam")});
  EXPECT_EQ(read.attributes, written.attributes);
  ASSERT_EQ(read.tables.size(), 2u);
  for (const auto& [name, t] : written.tables) {
    const Table& r = read.tables.at(name);
    ASSERT_EQ(r.factors.size(), t.factors.size());
    for (std::size_t j = 0; j < t.factors.size(); ++j) {
      EXPECT_EQ(r.factors[j].name, t.factors[j].name);
      EXPECT_EQ(r.factors[j].unit, t.factors[j].unit);
      EXPECT_EQ(r.factors[j].levels, t.factors[j].levels);
      EXPECT_EQ(r.factors[j].scale, t.factors[j].scale);
    }
    EXPECT_EQ(r.response_name, "frequency");
    EXPECT_EQ(r.response_unit, "Hz");
    EXPECT_EQ(r.values, t.values);
    ASSERT_EQ(r.holdout.size(), t.holdout.size());
    for (std::size_t k = 0; k < t.holdout.size(); ++k) {
      EXPECT_EQ(r.holdout[k].rmse, t.holdout[k].rmse);
      EXPECT_EQ(r.holdout[k].max_error, t.holdout[k].max_error);
      EXPECT_EQ(r.holdout[k].spread, t.holdout[k].spread);
      EXPECT_EQ(r.holdout[k].q2, t.holdout[k].q2);
    }
  }
}

TEST_F(TableFileTest, ScatteredRunsParametersAndAttributes) {
  Table t = example().tables.at("count_1");
  t.points = latin_hypercube(t.factors, 17, 1).points;
  t.values = RowMatrix::Random(17, 20);
  t.attributes = {{"emulator", "gaussian-process"}};
  t.parameters = {{"lengths", RowMatrix::Random(20, 2)}, {"nugget", RowMatrix::Random(20, 1)}};
  write_table_file(path(), {.attributes = {}, .tables = {{"count_1", t}}});
  const Table r = read_table_file(path()).tables.at("count_1");
  EXPECT_FALSE(r.is_grid());
  ASSERT_EQ(r.factors.size(), 2u);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(r.factors[j].name, t.factors[j].name);
    EXPECT_EQ(r.factors[j].levels, t.factors[j].levels);
    EXPECT_EQ(r.factors[j].scale, t.factors[j].scale);
  }
  EXPECT_EQ(r.points, t.points);
  EXPECT_EQ(r.values, t.values);
  EXPECT_EQ(r.attributes, t.attributes);
  EXPECT_EQ(r.parameters.at("lengths"), t.parameters.at("lengths"));
  EXPECT_EQ(r.parameters.at("nugget"), t.parameters.at("nugget"));
}

TEST_F(TableFileTest, ReadsAnIncompleteTableOnlyOnRequest) {
  TableFile file = example();
  file.tables["count_2"].values.row(7).setConstant(std::nan(""));
  write_table_file(path(), file);
  EXPECT_EQ(read_error(), Kind::incomplete);
  EXPECT_EQ(read_table_file(path(), {.allow_incomplete = true}).tables.at("count_2").missing_runs(),
            1);
}

TEST_F(TableFileTest, AnyNetcdfReaderSeesNamedDimensionsAndUnits) {
  write_table_file(path(), example());
  int file, group, variable, dimensions[8];
  ASSERT_EQ(nc_open(path().c_str(), NC_NOWRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_grp_ncid(file, "count_2", &group), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(group, "frequency", &variable), NC_NOERR);
  ASSERT_EQ(nc_inq_vardimid(group, variable, dimensions), NC_NOERR);
  const char* expected[] = {"location[1]", "reduction[1]", "location[2]", "reduction[2]",
                            "response"};
  for (int i = 0; i < 5; ++i) {
    char name[NC_MAX_NAME + 1] = {};
    nc_inq_dimname(group, dimensions[i], name);
    EXPECT_STREQ(name, expected[i]);
  }
  char units[8] = {};
  nc_get_att_text(group, variable, "units", units);
  EXPECT_STREQ(units, "Hz");
  nc_close(file);
}

TEST_F(TableFileTest, RejectsATableOfAnotherCase) {
  write_table_file(path(), example());
  EXPECT_EQ(read_error(), std::nullopt);
  EXPECT_EQ(read_error(io::fingerprint("another beam")), Kind::mismatch);
  TableFile anonymous = example();
  anonymous.attributes.erase("fingerprint");
  write_table_file(path(), anonymous);
  EXPECT_EQ(read_error(io::fingerprint("beam")), Kind::mismatch);
}

TEST_F(TableFileTest, MissingAndForeignFiles) {
  EXPECT_EQ(read_error(), Kind::missing);
  put("");
  EXPECT_EQ(read_error(), Kind::foreign);
  put("location,reduction,f1\n0.1,0.2,13.85\n");
  EXPECT_EQ(read_error(), Kind::foreign);
  fs::remove(path());
  fs::create_directory(path());
  EXPECT_EQ(read_error(), Kind::missing);
  fs::remove(path());
  int file;
  ASSERT_EQ(nc_create(path().c_str(), NC_NETCDF4, &file), NC_NOERR);
  nc_put_att_text(file, NC_GLOBAL, "title", 7, "weather");
  nc_close(file);
  EXPECT_EQ(read_error(), Kind::foreign);
}

TEST_F(TableFileTest, NamesOtherFormatVersions) {
  for (int version : {kTableFormatVersion - 1, kTableFormatVersion + 1}) {
    write_table_file(path(), example());
    int file;
    ASSERT_EQ(nc_open(path().c_str(), NC_WRITE, &file), NC_NOERR);
    nc_put_att_int(file, NC_GLOBAL, "table_format_version", NC_INT, 1, &version);
    nc_close(file);
    EXPECT_EQ(read_error(), Kind::version);
  }
}

TEST_F(TableFileTest, TruncatedFilesAreCorrupt) {
  write_table_file(path(), example());
  const std::string whole = bytes();
  for (int part = 1; part < 40; ++part) {
    put(whole.substr(0, whole.size() * static_cast<std::size_t>(part) / 40));
    EXPECT_EQ(read_error(), Kind::corrupt) << part << "/40 of the file";
  }
  put(whole.substr(0, whole.size() - 1));
  EXPECT_EQ(read_error(), Kind::corrupt);
}

TEST_F(TableFileTest, ADamagedByteNeverChangesWhatIsRead) {
  const TableFile file = example();
  write_table_file(path(), file);
  const std::string whole = bytes();
  int noticed = 0;
  for (std::size_t at = 8; at < whole.size(); at += whole.size() / 150) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    try {
      const TableFile read = parse_table_file(damaged, path());
      EXPECT_EQ(read.attributes, file.attributes);
      ASSERT_EQ(read.tables.size(), 2u);
      for (const auto& [name, t] : file.tables)
        EXPECT_TRUE(read.tables.at(name).values == t.values) << "byte " << at;
    } catch (const io::FileError&) {
      ++noticed;
    }
  }
  EXPECT_GT(noticed, 50);
}

TEST_F(TableFileTest, AnInconsistentFileIsCorrupt) {
  write_table_file(path(), example());
  int file, group, variable;
  ASSERT_EQ(nc_open(path().c_str(), NC_WRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_grp_ncid(file, "count_1", &group), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(group, "location[1]", &variable), NC_NOERR);
  const double unordered[] = {0.25, 0.15, 0.05};
  nc_put_var_double(group, variable, unordered);
  nc_close(file);
  EXPECT_EQ(read_error(), Kind::corrupt);
}

TEST_F(TableFileTest, UnwritableOutput) {
  const fs::path nowhere = path("absent") / "table.nc";
  try {
    write_table_file(nowhere, example());
    FAIL();
  } catch (const io::FileError& error) {
    EXPECT_EQ(error.kind(), Kind::unwritable);
    EXPECT_EQ(error.path(), nowhere);
  }
  fs::create_directories(path("is_a_directory") / "full");
  EXPECT_THROW(write_table_file(path("is_a_directory"), example()), io::FileError);
  EXPECT_EQ(directory.files(), 1) << "no temporary file stays behind";
}

TEST_F(TableFileTest, AFailedWriteLeavesTheOldFile) {
  write_table_file(path(), example());
  TableFile bad = example();
  bad.attributes["no/slash/allowed"] = "";
  EXPECT_THROW(write_table_file(path(), bad), io::FileError);
  EXPECT_EQ(read_error(), std::nullopt);
  EXPECT_EQ(directory.files(), 1);
}

TEST_F(TableFileTest, RejectsInconsistentTables) {
  TableFile wrong_rows = example();
  wrong_rows.tables["count_1"].values = RowMatrix::Zero(11, 20);
  EXPECT_THROW(write_table_file(path(), wrong_rows), std::invalid_argument);
  TableFile wrong_holdout = example();
  wrong_holdout.tables["count_2"].holdout.pop_back();
  EXPECT_THROW(write_table_file(path(), wrong_holdout), std::invalid_argument);
  TableFile clash = example();
  clash.tables["count_1"].response_name = "location[1]";
  EXPECT_THROW(write_table_file(path(), clash), std::invalid_argument);
  EXPECT_EQ(directory.files(), 0);
}

TEST_F(TableFileTest, ThreadsMayReadAndWriteAtOnce) {
  const TableFile file = example();
  std::vector<std::jthread> crew;
  for (int t = 0; t < 4; ++t)
    crew.emplace_back([&, t] {
      const fs::path mine = path("table" + std::to_string(t) + ".nc");
      for (int i = 0; i < 3; ++i) {
        write_table_file(mine, file);
        EXPECT_EQ(read_table_file(mine).tables.at("count_2").values,
                  file.tables.at("count_2").values);
      }
    });
}

TEST(Fingerprint, ReferenceValuesOfFnv1a) {
  EXPECT_EQ(io::fingerprint(""), "cbf29ce484222325");
  EXPECT_EQ(io::fingerprint("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(io::fingerprint("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace wheeltap::emulator
