#include "io/formats/numpy_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "io/formats/formats.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/io/zip_writer.hpp"

namespace wheeltap::io::numpy_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class T>
std::string data(const std::vector<T>& values, bool big_endian = false) {
  std::string out;
  for (const T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian) std::reverse(raw, raw + sizeof(T));
    out.append(raw, sizeof(T));
  }
  return out;
}

std::string npy(const std::string& descr, const std::string& shape, const std::string& values,
                const std::string& fortran = "False") {
  std::string header =
      "{'descr': " + descr + ", 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
  header.resize(118, ' ');
  return std::string("\x93NUMPY\1\0", 8) + test::little_endian(118, 2) + header + values;
}

Columns read(const std::string& bytes) {
  return parse_npy(bytes, "acc.npy", {}, {});
}

std::vector<double> column(const Columns& table, const char* name) {
  return table.columns.at(static_cast<std::size_t>(table.find(name))).values;
}

std::string fault(const std::string& bytes) {
  try {
    static_cast<void>(read(bytes));
  } catch (const FileError& error) {
    return error.reason();
  }
  return {};
}

TEST(NumpyFile, ReadsEveryTypeAndByteOrder) {
  const std::vector<double> expected = {1.0, 2.0, 3.0};
  EXPECT_EQ(column(read(npy("'<f8'", "(3,)", data<double>({1, 2, 3}))), "acc"), expected);
  EXPECT_EQ(column(read(npy("'<f4'", "(3,)", data<float>({1, 2, 3}))), "acc"), expected);
  EXPECT_EQ(
      column(read(npy("'<f2'", "(3,)", data<std::uint16_t>({0x3C00, 0x4000, 0x4200}))), "acc"),
      expected);
  EXPECT_EQ(column(read(npy("'>f8'", "(3,)", data<double>({1, 2, 3}, true))), "acc"), expected);
  EXPECT_EQ(column(read(npy("'>i2'", "(3,)", data<std::int16_t>({1, 2, 3}, true))), "acc"),
            expected);
  EXPECT_EQ(column(read(npy("'<i8'", "(3,)", data<std::int64_t>({1, 2, 3}))), "acc"), expected);
  EXPECT_EQ(column(read(npy("'|u1'", "(3,)", std::string("\1\2\3", 3))), "acc"), expected);
  EXPECT_EQ(column(read(npy("'|b1'", "(2,)", std::string("\1\0", 2))), "acc"),
            (std::vector<double>{1.0, 0.0}));
  const Columns times = read(npy("'<M8[ms]'", "(3,)", data<std::int64_t>({9000, 9500, 10000})));
  EXPECT_EQ(times.columns[0].header, "acc [s]");
  EXPECT_THAT(times.columns[0].values, ElementsAre(0.0, 0.5, 1.0)) << "since the first time";
  // Nanoseconds since 1970 exceed 2⁵³: differences as double were multiples of 256 ns.
  constexpr std::int64_t kNow = 1'764'547'200'000'000'001;
  const Columns fine =
      read(npy("'<M8[ns]'", "(3,)", data<std::int64_t>({kNow, kNow + 19'531, kNow + 39'062})));
  EXPECT_THAT(fine.columns[0].values, ElementsAre(0.0, 19'531e-9, 39'062e-9));
}

TEST(NumpyFile, MatricesOfEitherOrderAndComplexArraysAreColumns) {
  const std::vector<double> x = {1, 2, 3, 4, 5, 6};
  EXPECT_THAT(column(read(npy("'<f8'", "(3, 2)", data(x))), "acc(:,2)"),
              ElementsAre(2.0, 4.0, 6.0));
  EXPECT_THAT(column(read(npy("'<f8'", "(3, 2)", data(x), "True")), "acc(:,2)"),
              ElementsAre(4.0, 5.0, 6.0));
  EXPECT_THAT(column(read(npy("'<f8'", "(2, 3)", data(x))), "acc(2,:)"),
              ElementsAre(4.0, 5.0, 6.0));
  EXPECT_THAT(column(read(npy("'<c16'", "(3,)", data(x))), "acc, imaginary"),
              ElementsAre(2.0, 4.0, 6.0));
  const Columns stated =
      parse_npy(npy("'<f8'", "(3, 2)", data(x)), "acc.npy", {}, {.rows_are_channels = true});
  EXPECT_THAT(column(stated, "acc(3,:)"), ElementsAre(5.0, 6.0));
}

TEST(NumpyFile, ArraysOfAnArchiveAreColumnsAndScalars) {
  const std::vector<std::pair<std::string, std::string>> members = {
      {"fs.npy", npy("'<f8'", "()", data<double>({200.0}))},
      {"acc.npy", npy("'<f8'", "(4, 2)", data<double>({1, 2, 3, 4, 5, 6, 7, 8}))},
      {"temperature.npy", npy("'<f4'", "(2,)", data<float>({20, 21}))},
      {"names.npy", npy("'<U3'", "(2,)", std::string(24, 'a'))}};
  for (const bool packed : {false, true}) {
    const Columns t = parse_npz(test::zip(members, packed), "r.npz", {}, {});
    EXPECT_EQ(t.scalars.at("fs"), 200.0);
    EXPECT_THAT(column(t, "acc(:,2)"), ElementsAre(2.0, 4.0, 6.0, 8.0));
    EXPECT_THAT(t.others, ElementsAre("names (text)",
                                      HasSubstr("temperature (2 x 1, of another length: to read")));
  }
}

TEST(NumpyFile, IsRecognisedByMagicAndExtension) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "x.npy", npy("'<f8'", "(3,)", data<double>({1, 2, 3})));
  EXPECT_EQ(read_columns(directory / "x.npy").rows(), 3);
  test::put_bytes(directory / "x.npz",
                  test::zip({{"y.npy", npy("'<f8'", "(3,)", data<double>({1, 2, 3}))}}));
  EXPECT_EQ(read_columns(directory / "x.npz").rows(), 3);
}

TEST(NumpyFile, RejectsNonNumericArraysWithTheRemedy) {
  EXPECT_THAT(fault(npy("[('t', '<f8'), ('a', '<f4')]", "(3,)", std::string(36, '\0'))),
              HasSubstr("numpy.savez"));
  EXPECT_THAT(fault(npy("'|O'", "(3,)", "pickle")), HasSubstr("astype(float)"));
  EXPECT_THAT(fault(npy("'<f16'", "(3,)", std::string(48, '\0'))), HasSubstr("'<f16'"));
}

TEST(NumpyFile, RejectsFilesTruncatedAtAnyByte) {
  const std::string whole = npy("'<f8'", "(3,)", data<double>({1, 2, 3}));
  for (std::size_t kept = 0; kept < whole.size(); ++kept)
    EXPECT_THROW(static_cast<void>(read(whole.substr(0, kept))), FileError) << kept;
  const std::string archive = test::zip({{"y.npy", whole}}, true);
  for (std::size_t kept = 0; kept < archive.size(); ++kept)
    EXPECT_THROW(static_cast<void>(parse_npz(archive.substr(0, kept), "x.npz", {}, {})), FileError)
        << kept;
  for (std::size_t at = 40; at < 60; ++at) {
    std::string damaged = archive;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    EXPECT_THROW(static_cast<void>(parse_npz(damaged, "x.npz", {}, {})), FileError) << at;
  }
  EXPECT_THROW(static_cast<void>(read(npy("'<f8'", "(99999999999, 99999999999)", "12345678"))),
               FileError);
}

}  // namespace
}  // namespace wheeltap::io::numpy_file_test
