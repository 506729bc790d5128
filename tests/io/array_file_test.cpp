#include "io/netcdf/array_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/formats/formats.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ArrayFile : public testing::Test {
 protected:
  /// A record of 4 samples in any of NetCDF's formats.
  void write(const std::filesystem::path& path, int format) const {
    int file = 0, rows = 0, three = 0, id = 0, group = 0;
    ASSERT_EQ(nc_create(path.c_str(), format, &file), NC_NOERR);
    nc_def_dim(file, "sample", 4, &rows);
    nc_def_dim(file, "channel", 3, &three);
    const int flat[] = {rows, three}, across[] = {three, rows};
    const auto put = [&](int where, const char* name, nc_type type, int rank, const int* dimensions,
                         const std::vector<double>& x) {
      nc_redef(file);
      ASSERT_EQ(nc_def_var(where, name, type, rank, dimensions, &id), NC_NOERR);
      if (std::string(name) == "time") nc_put_att_text(where, id, "units", 1, "s");
      if (std::string(name) == "raw") {
        const double scale = 0.5, offset = 1.0;
        const short hole = -999;
        nc_put_att_double(where, id, "scale_factor", NC_DOUBLE, 1, &scale);
        nc_put_att_double(where, id, "add_offset", NC_DOUBLE, 1, &offset);
        nc_put_att_short(where, id, "missing_value", NC_SHORT, 1, &hole);
      }
      nc_enddef(file);
      ASSERT_EQ(nc_put_var_double(where, id, x.data()), NC_NOERR);
    };
    put(file, "time", NC_DOUBLE, 1, &rows, {0.0, 0.1, 0.2, 0.3});
    put(file, "a", NC_FLOAT, 2, flat, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    put(file, "b", NC_DOUBLE, 2, across, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    put(file, "raw", NC_SHORT, 1, &rows, {2, 4, -999, 8});
    put(file, "rate", NC_DOUBLE, 0, nullptr, {10.0});
    put(file, "calibration", NC_DOUBLE, 1, &three, {1.0, 2.0, 3.0});
    if ((format & NC_NETCDF4) != 0) {
      ASSERT_EQ(nc_def_grp(file, "daq", &group), NC_NOERR);
      put(group, "extra", NC_DOUBLE, 1, &rows, {9.0, 8.0, 7.0, 6.0});
    }
    nc_close(file);
  }
  /// A file that grew sample by sample, with two variables.
  static void write_records(const std::filesystem::path& path, int format) {
    int file = 0, rows = 0, time = 0, a = 0;
    ASSERT_EQ(nc_create(path.c_str(), format, &file), NC_NOERR);
    nc_def_dim(file, "sample", NC_UNLIMITED, &rows);
    nc_def_var(file, "time", NC_DOUBLE, 1, &rows, &time);
    nc_def_var(file, "a", NC_SHORT, 1, &rows, &a);
    nc_enddef(file);
    for (std::size_t i = 0; i < 5; ++i) {
      const double t = 0.1 * static_cast<double>(i);
      const short x = static_cast<short>(i * i);
      ASSERT_EQ(nc_put_var1_double(file, time, &i, &t), NC_NOERR);
      ASSERT_EQ(nc_put_var1_short(file, a, &i, &x), NC_NOERR);
    }
    nc_close(file);
  }
  test::TemporaryDirectory directory;
};

TEST_F(ArrayFile, VectorsAndMatricesAreColumns) {
  for (const int format : {0, NC_64BIT_OFFSET, NC_NETCDF4}) {
    const auto path = directory / ("record" + std::to_string(format) + ".nc");
    write(path, NC_CLOBBER | format);
    const Columns c = read_columns(path);
    EXPECT_EQ(c.columns[0].header, "time [s]");
    EXPECT_EQ(c.rows(), 4);
    const auto values = [&](const char* name) {
      return c.columns[static_cast<std::size_t>(c.find(name))].values;
    };
    EXPECT_THAT(values("a(:,2)"), ElementsAre(2.0, 5.0, 8.0, 11.0));
    EXPECT_THAT(values("b(2,:)"), ElementsAre(5.0, 6.0, 7.0, 8.0));
    const std::vector<double> raw = values("raw");
    EXPECT_EQ(raw[0], 2.0);
    EXPECT_TRUE(std::isnan(raw[2]));
    EXPECT_EQ(c.scalars.at("rate"), 10.0);
    if ((format & NC_NETCDF4) != 0) {
      EXPECT_THAT(values("daq/extra"), ElementsAre(9.0, 8.0, 7.0, 6.0));
    }
    EXPECT_THROW(values("calibration"), FileError) << "of another length";
    EXPECT_THAT(c.others, ElementsAre("calibration (3 x 1, of another length: to read it, name "
                                      "'calibration' in the case)"));
  }
}

TEST_F(ArrayFile, ReadsOnlyRequestedColumns) {
  write(directory / "r.h5", NC_CLOBBER | NC_NETCDF4);
  const Columns c = read_columns(directory / "r.h5", [](const Columns& all, std::size_t i) {
    return all.columns[i].name == "time";
  });
  EXPECT_EQ(c.columns[0].values.size(), 4U);
  EXPECT_TRUE(c.columns[1].values.empty());
}

TEST_F(ArrayFile, ReadsAVariableOfAnotherLengthByName) {
  write(directory / "r.nc", NC_CLOBBER);
  const Columns c = read_columns(directory / "r.nc", [](const Columns& all, std::size_t i) {
    return all.columns[i].name == "calibration";
  });
  EXPECT_THAT(c.columns.at(static_cast<std::size_t>(c.find("calibration"))).values,
              ElementsAre(1.0, 2.0, 3.0));
}

TEST_F(ArrayFile, RowsAreChannelsIfStated) {
  write(directory / "r.nc", NC_CLOBBER);
  const auto of_a = [](const Columns& all, std::size_t i) {
    return all.columns[i].name.starts_with("a(");
  };
  const Columns c =
      read_columns(directory / "r.nc", of_a, formats(), {}, {.rows_are_channels = true});
  EXPECT_THAT(c.columns.at(static_cast<std::size_t>(c.find("a(2,:)"))).values,
              ElementsAre(4.0, 5.0, 6.0));
  test::put_bytes(directory / "r.csv", "a,b\n1,2\n");
  EXPECT_THROW(
      (void)read_columns(directory / "r.csv", {}, formats(), {}, {.rows_are_channels = true}),
      FileError)
      << "a text has no arrays";
}

TEST_F(ArrayFile, ArraysOfThreeDimensionsAndComplexOnesAreColumns) {
  int file = 0, type = 0, id = 0;
  int dimensions[3] = {};
  ASSERT_EQ(nc_create((directory / "frf.h5").c_str(), NC_CLOBBER | NC_NETCDF4, &file), NC_NOERR);
  const std::size_t lengths[] = {2, 1, 4};
  for (int k = 0; k < 3; ++k)
    nc_def_dim(file, ("d" + std::to_string(k)).c_str(), lengths[k], &dimensions[k]);
  ASSERT_EQ(nc_def_compound(file, 16, "complex", &type), NC_NOERR);
  nc_insert_compound(file, type, "r", 0, NC_DOUBLE);
  nc_insert_compound(file, type, "i", 8, NC_DOUBLE);
  ASSERT_EQ(nc_def_var(file, "H", type, 3, dimensions, &id), NC_NOERR);
  std::vector<double> values;
  for (int i = 0; i < 8; ++i) values.insert(values.end(), {1.0 * i, -1.0 * i});
  ASSERT_EQ(nc_put_var(file, id, values.data()), NC_NOERR);
  ASSERT_EQ(nc_def_var(file, "note", NC_CHAR, 1, dimensions, &id), NC_NOERR);
  nc_close(file);
  const Columns c = read_columns(directory / "frf.h5");
  EXPECT_THAT(c.columns.at(static_cast<std::size_t>(c.find("H(2,1,:), real"))).values,
              ElementsAre(4.0, 5.0, 6.0, 7.0));
  EXPECT_THAT(c.columns.at(static_cast<std::size_t>(c.find("H(1,1,:), imaginary"))).values,
              ElementsAre(0.0, -1.0, -2.0, -3.0));
  EXPECT_THAT(c.others, ElementsAre("note (text)"));
}

TEST_F(ArrayFile, RejectsFilesWithoutARecord) {
  const auto kind = [&](const std::filesystem::path& path) {
    try {
      (void)read_array_file(path, {});
    } catch (const FileError& e) {
      return e.kind();
    }
    return FileError::Kind::mismatch;
  };
  EXPECT_EQ(kind(directory / "none.nc"), FileError::Kind::missing);
  test::put_bytes(directory / "cut.nc", "CDF\x01");
  EXPECT_EQ(kind(directory / "cut.nc"), FileError::Kind::corrupt);
  int file = 0;
  nc_create((directory / "empty.nc").c_str(), NC_CLOBBER, &file);
  nc_close(file);
  EXPECT_EQ(kind(directory / "empty.nc"), FileError::Kind::foreign);
}

// The library reads zeros beyond the end of a truncated classic file.
TEST_F(ArrayFile, RejectsFilesTruncatedAtAnyByte) {
  for (const int format : {NC_CLOBBER, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4}) {
    for (const bool records : {false, true}) {
      const auto path = directory / "whole.nc";
      if (records)
        write_records(path, format);
      else
        write(path, format);
      ASSERT_FALSE(read_array_file(path, {}).columns.empty()) << format;
      const std::string whole = test::bytes_of(path);
      // Up to three bytes pad the last value of 2 bytes to four.
      for (std::size_t kept = whole.size() - 4; kept > 8;
           kept -= std::min(kept, whole.size() / 40)) {
        test::put_bytes(directory / "cut.nc", whole.substr(0, kept));
        EXPECT_THROW((void)read_array_file(directory / "cut.nc", {}), FileError)
            << format << ", " << kept << " of " << whole.size();
      }
    }
  }
}

}  // namespace
}  // namespace wheeltap::io
